// The live lab with things that can be grasped, pushed and dropped, by the emulated shafts.
//
//   shafts --> links, jaws --> contact, friction, gravity (dynamics/thing_world) --> where every thing truly stands
//
// Truth and model are two things: masses, friction and places differ from what lab_things() and the lab's model say.
#pragma once

#include <deque>
#include <memory>
#include <mutex>

#include "dynamics/thing_world.hpp"
#include "sim/live_lab.hpp"
#include "sim/physics/lab_things.hpp"

namespace foresight::sim {

/// Each value is drawn evenly from -size .. size, for every thing by itself.
struct HiddenPhysics {
  unsigned seed = 1;
  double mass = 0.2, friction = 0.2;  ///< shares, 0 .. 0.9
  double place_m = 0.002;             ///< in x and in y, 0 .. 0.05
  double turn_rad = 0.02;             ///< about z
};

struct PhysicsOptions {
  HiddenPhysics hidden = {};
  std::vector<LooseThing> things = lab_things();  ///< those that the lab lacks are left out
  std::vector<std::string> jaws = {"finger"};     ///< joints of the gripper; those of the lab's own arm
  double jaw_force = 50;                          ///< N: ThingWorldOptions
  BodyWorldOptions bodies = {};
};

/// Any thread. It goes on in fixed steps from its start, as far as it is asked for, and asks the shafts where they were
/// at each: who asks and when makes no difference, so that in stepped time all is repeatable, bit for bit.
class PhysicalLab {
 public:
  /// How long it remembers; what nobody asked for in longer than that stood still in between.
  static constexpr Duration kRemembered = std::chrono::seconds(3);

  /// All things come to rest first, with the shafts as they are at `start`. `shafts` is asked on the threads that ask
  /// this. Throws InputError: a deviation out of range, a thing that LiveLab::Options::loose lacks, what ThingWorld
  /// does.
  PhysicalLab(std::shared_ptr<const LiveLab> lab, ShaftsAt shafts, RobotTime start, const PhysicsOptions& options = {});

  const LiveLab& lab() const { return *lab_; }
  /// Where every part truly stands, with jaws where what they hold lets them be.
  LabState state_at(RobotTime time);
  /// Of a thing, at `time`. Throws std::out_of_range: no such thing.
  Pose thing_at(const std::string& name, RobotTime time);
  /// Is it held by the jaws, where time has come to.
  bool gripped(const std::string& name) const;
  /// Joints, where time has come to: those of the jaws are where these truly are.
  double jaw_lag(std::string_view joint) const;

  /// Puts a thing elsewhere, at rest: an accident that nobody sees. Throws as thing_at().
  void displace(const std::string& name, const Pose& T_world_thing);

 private:
  struct Thing {
    std::size_t part = 0;
    std::string name;
  };
  struct Instant {
    RobotTime time;
    std::vector<Motion> things;
    std::vector<std::pair<std::string, double>> lags;  // of the jaws
  };
  void advance(RobotTime time);
  void remember(RobotTime time);
  const Instant& before(RobotTime time) const;
  const Thing& find(const std::string& name) const;
  ShaftPositions shafts_at(RobotTime time) const;

  const std::shared_ptr<const LiveLab> lab_;
  const ShaftsAt shafts_;
  const RobotTime start_;
  const std::vector<std::string> jaws_;
  std::vector<Thing> things_;
  mutable std::mutex mutex_;  // all below
  std::unique_ptr<ThingWorld> world_;
  std::int64_t steps_ = 0;
  std::deque<Instant> past_;  // oldest first; never empty
};

}  // namespace foresight::sim

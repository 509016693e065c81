// A robot among things: its links push them, its jaws close around them with bounded force, friction holds them.
//
// Jaws are sprung: the shaft of their joint goes where its drive takes it, and the jaws with it until what they press
// resists with more than the spring's force. Then they stay, and the shaft goes on alone. All links that the joint
// moves are its jaws, mirrored ones and those that turn too:
//
//   Q = sum over touches of f . dx/dq       f: force on the jaw, x: where it is touched, q: the joint's position
//
// q goes towards the shaft while |Q| is below the spring's force. What is touched softly (Surface::stiffness) lets Q
// grow evenly with q.
#pragma once

#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "dynamics/body_world.hpp"
#include "scene/robot_scene.hpp"

namespace foresight {

enum class PartRole : std::uint8_t { still, driven, loose };

struct WorldPart {
  Mesh mesh;
  PartRole role = PartRole::still;
  Pose T_world_part = Pose::Identity();  ///< at the start; of driven ones, the robot's word counts
  double mass = 0;                       ///< kg, of loose ones
  Surface surface;
};

/// T_world_part of all parts for given joints; only what it says of driven ones counts.
using PartPoses = std::function<std::vector<Pose>(const JointPositions&)>;

struct ThingWorldOptions {
  BodyWorldOptions bodies = {};
  double floor = -0.75;                ///< m: below this height all is solid
  std::vector<std::string> jaws = {};  ///< joints whose links are jaws
  double jaw_force = 50;    ///< N (Nm of a joint that turns), > 0: the spring's, of all jaws of a joint together
  double jaw_speed = 0.05;  ///< m/s (rad/s), > 0: that a jaw goes back to its shaft with
  Surface jaw_surface = {.friction = 1, .restitution = 0, .stiffness = 1e4, .damping = 20};  ///< instead of the part's
};

/// One thread. The same calls give the same motion, bit for bit.
class ThingWorld {
 public:
  /// Throws InputError: what BodyWorld does; a force or speed that is not positive.
  ThingWorld(const std::vector<WorldPart>& parts, PartPoses robot, ThingWorldOptions options,
             const JointPositions& joints);

  /// One step: `joints` are where the shafts are at its end.
  void step(const JointPositions& joints);

  /// Where the jaws' joints truly are, and all others as told.
  JointPositions with_jaws(const JointPositions& joints) const;
  /// How far the jaws are kept from their shafts, rad or m; > 0: held open.
  double jaw_lag(std::string_view joint) const;
  /// The number of the joint (of ThingWorldOptions::jaws) whose jaws press it from opposite sides, or one of which
  /// presses it against another link; -1: none.
  int gripped_by(std::size_t loose) const;
  bool gripped(std::size_t loose) const { return gripped_by(loose) >= 0; }
  /// A frame that stands still in the hand while the jaws of a joint go: in their middle, parallel to the first.
  Pose grip_frame(std::size_t jaw, const JointPositions& joints) const;
  struct JawState {
    double position = 0, shaft = 0, force = 0;  ///< the force resists; > 0: wants to open towards larger positions
  };
  JawState jaw(std::size_t number) const { return {jaws_[number].position, jaws_[number].shaft, jaws_[number].force}; }
  /// From now on, the jaws do not pass where they are, as something that is held is between them: `opening` 1 or -1 is
  /// the way in which they may go; 0: they are free again.
  void block_jaw(std::size_t number, int opening);
  /// How far blocked jaws have opened since, rad or m; 0 where they are free.
  double opened_by(std::size_t number) const;
  /// The part moves with a jaw's joint and no other of its parents: one of the jaws themselves.
  bool is_jaw(std::size_t part) const { return jaw_of_[part] >= 0; }

  PartRole role(std::size_t part) const { return roles_[part]; }
  std::size_t size() const { return roles_.size(); }
  Motion motion(std::size_t part) const { return bodies_.motion(part); }
  void put(std::size_t part, const Motion& motion) { bodies_.put(part, motion); }
  /// See BodyWorld.
  void rest(std::size_t loose, const Pose& T_world_part) { bodies_.rest(loose, T_world_part); }
  void set_present(std::size_t part, bool present) { bodies_.set_present(part, present); }
  void hold(std::size_t loose, bool held) { bodies_.hold(loose, held); }
  void place(std::size_t held, const Pose& T_world_part) { bodies_.place(held, T_world_part); }
  const std::vector<Touch>& touches() const { return bodies_.touches(); }
  double seconds_per_step() const { return bodies_.seconds_per_step(); }

 private:
  struct Jaw {
    std::string joint;
    double position = 0, shaft = 0;
    double force = 0;      // Q
    double stiffness = 0;  // dQ / dq
    int opening = 0;       // blocked where `block` is, but for this way
    double block = 0;
  };
  void find_jaws(const JointPositions& joints, const std::vector<Pose>& rest);
  void measure(const JointPositions& joints);
  void move(Jaw& jaw, double shaft) const;

  std::vector<PartRole> roles_;
  PartPoses robot_;
  ThingWorldOptions options_;
  BodyWorld bodies_;
  std::vector<Jaw> jaws_;
  std::vector<int> jaw_of_;  // of each part, index into jaws_; -1: none
};

}  // namespace foresight

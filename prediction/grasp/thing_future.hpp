// Things as they will be: the hand that will be takes them along at once; what cameras see later sets them right.
//
//   predicted joints --> jaws close on a thing --> it goes with the hand --> they open --> it falls, comes to rest
//                          (contact: dynamics/thing_world)                     (dynamics/thing_world)
//   sighting of the instant t --> compared with where the thing was shown for t --> a little off: blended in
//                                                                           '--> elsewhere twice: put where it is seen
//
// A thing's life is a chain of spells: at rest, carried, in motion. While at rest its place in the world is one
// unknown, while carried its place in the hand: sightings of a spell estimate that one unknown, whatever the delay
// (Kalman's filter of a constant, with the noise that the sighting tells). The world's settings are the model's own,
// not the truth's.
//
// What is shown never jumps (correction_blend.hpp). All instants are of the robot's clock. Metres, rad.
#pragma once

#include <deque>
#include <string>
#include <vector>

#include "dynamics/thing_world.hpp"
#include "prediction/correction_blend.hpp"
#include "scene/scene_model.hpp"

namespace foresight {

inline constexpr double kJawsOpened = 5e-4;  ///< m or rad that jaws go back before what they hold is let go

enum class ThingStatus : std::uint8_t {
  seen,       ///< at rest where cameras saw it
  carried,    ///< in the hand
  falling,    ///< in motion: falls, rolls, is pushed
  predicted,  ///< at rest where it should have come to, not yet seen there
  unsure,     ///< cameras contradict: elsewhere than shown, or not there at all
};
const char* name_of(ThingStatus status) noexcept;

/// What is known of a thing beforehand.
struct KnownThing {
  std::string node;  ///< of the scene's model
  double mass = 0;   ///< kg, > 0
  Surface surface;
};

struct PredictedThing {
  ThingStatus status = ThingStatus::unsure;
  Pose T_world_thing = Pose::Identity();
  double sigma = 0, sigma_rad = 0;  ///< one standard deviation of its place, and of its rotation; infinite where absent
  bool held = false;                ///< in the hand, also while that is doubted
};

/// Where cameras found a thing at one instant: by its tag, by its textured mesh, by whatever means.
struct ThingSighting {
  std::size_t thing = 0;  ///< index into ThingFutureOptions::things
  RobotTime captured;
  Pose T_world_thing = Pose::Identity();
  double sigma = 0.002, sigma_rad = 0.02;  ///< > 0: one standard deviation
};

/// What became of a sighting.
enum class SightingResult : std::uint8_t {
  taken,        ///< agrees, and is blended in
  doubted,      ///< contradicts; a second one will decide
  moved,        ///< contradicts again: the thing is where it is seen now
  taken_back,   ///< goes with the hand that it was thought to have slipped from: it is in it
  not_a_thing,  ///< no thing of that number
  not_a_pose,   ///< numbers that are not finite, no rotation, or a sigma that is not positive
  not_known,    ///< of an instant before all that is remembered, or not yet shown
  in_motion,    ///< the thing was in motion then, and may well have been there: nothing to learn
};

struct ThingFutureOptions {
  std::vector<KnownThing> things;
  std::vector<std::string> jaws;  ///< joints of the gripper
  double jaw_force = 50;          ///< N
  double floor = -0.75;           ///< m
  BodyWorldOptions bodies = {.step = 0.004, .iterations = 30};
  double model = 0.01, model_rad = 0.1;    ///< one sigma of places by the model, until they are seen
  double grasp = 0.002, grasp_rad = 0.02;  ///< that closing jaws add
  double fall = 0.015, fall_rad = 0.2;     ///< that motion adds at most: as much as the thing moved, where that is less
  double slip = 0.001;                     ///< that a thing may wander in the hand, per square root of a second
  double least_gate = 0.006;               ///< nearer than this, nothing contradicts
};

/// One thread. The same calls give the same motion, bit for bit.
class ThingFuture {
 public:
  static constexpr double kMemory = 6;  ///< s that sightings may be late

  /// Joints move the nodes that may move and are no things. `robot`: T_world_node for given joints. The rest poses are
  /// where the things are at `start`. Throws InputError: a thing that the model does not have or that is named twice,
  /// what ThingWorld throws.
  ThingFuture(const SceneModel& model, PartPoses robot, ThingFutureOptions options, RobotTime start,
              const JointPositions& joints);

  /// Time has come to `time`, at which the robot is there; what lies between is even. Earlier instants change nothing.
  /// A gap of more than a second counts as one second.
  void advance(RobotTime time, const JointPositions& joints);

  /// `joints`: where the robot truly was at that instant, where that is known, else null.
  SightingResult correct(const ThingSighting& sighting, const JointPositions* joints = nullptr);
  /// A camera looked at where the thing should have been at `captured`, with nothing in between, and it is not there.
  /// The third such word within a second makes it absent, until it is seen again: in no hand, and nowhere known.
  void absent(std::size_t thing, RobotTime captured);

  std::size_t size() const { return things_.size(); }
  RobotTime time() const { return now_; }
  /// As shown for time().
  PredictedThing thing(std::size_t thing) const;
  /// Where it was at `time`, by all that is known of it by now: what has just been learnt counts for the past too.
  /// Nothing for instants that are not remembered, or after time().
  std::optional<Pose> at(std::size_t thing, RobotTime time) const;
  /// Where the hand had it at `time`, with the robot there, if it has not slipped from it after all: nothing where it
  /// is in it by what is known, or where the jaws have been opened.
  std::optional<Pose> if_still_in_hand(std::size_t thing, RobotTime time, const JointPositions& joints) const;
  /// T_world_node of all nodes for time(): the robot with its jaws where what they hold lets them be, and the things.
  std::vector<Pose> poses() const;
  /// Things that were found elsewhere than shown while they should have been in the hand.
  std::size_t failed_grasps() const { return failed_; }

 private:
  enum class Kind : std::uint8_t { rest, carried, moving };
  struct Spell {
    std::uint64_t number = 0;
    Kind kind = Kind::rest;
    Pose T = Pose::Identity();  // rest: T_world_thing; carried: T_grip_thing
    double variance = 0, variance_rad = 0;
    RobotTime begin, seen;
    bool any_seen = false;
    std::size_t jaw = 0;
  };
  struct Moment {
    RobotTime time;
    std::uint64_t spell = 0;
    Pose T_world_thing = Pose::Identity();  // as the model had it
  };
  struct Doubt {
    RobotTime captured;
    Pose T_world_thing = Pose::Identity(), T_grip_thing = Pose::Identity();
    double gates_off = 0;  // from where the thing was shown
  };
  struct Thing {
    std::string name;
    std::deque<Doubt> seen;  // sightings of the last second, by the grip that held it last
    std::size_t node = 0;
    std::deque<Spell> spells;  // oldest first; the last is of now
    std::deque<Moment> past;
    std::deque<Doubt> doubts;
    std::deque<RobotTime> absences;
    bool gone = false;
    int gripped_steps = 0, still_steps = 0;
    CorrectionBlend place[3], turn[3];
  };

  void step(const JointPositions& joints);
  static bool rests(const Thing& thing) { return !thing.gone && thing.spells.back().kind == Kind::rest; }
  bool is_touched_by_what_moves(const Thing& thing) const;
  void follow(Thing& thing, const JointPositions& joints);
  void come_to_rest(Thing& thing, const Pose& T_world_thing);
  void remember(Thing& thing, RobotTime time) const;
  void take_along(Thing& thing, std::size_t jaw, const JointPositions& joints);
  void let_go(Thing& thing, Kind kind, const Pose& T_world_thing);
  void begin_spell(Thing& thing, Kind kind, const Pose& T, double variance, double variance_rad);
  static Pose expected_pose(const Spell& spell, const Moment& then, const Pose& T_world_grip);
  double gates_off(const Spell& spell, const Pose& expected, const ThingSighting& sighting) const;
  void agree(Thing& thing, Spell& spell, const Pose& expected, const ThingSighting& sighting, const Pose& T_world_grip);
  SightingResult contradict(Thing& thing, Spell& spell, const ThingSighting& sighting, const Pose& T_world_grip,
                            double gates_off);
  void put_where_seen(Thing& thing, const ThingSighting& sighting, std::uint64_t since);
  bool shift_in_hand(Thing& thing, Spell& spell, const ThingSighting& sighting);
  void place_anew(Thing& thing);
  static const Spell* last_carried(const Thing& thing);
  bool jaws_opened_since(std::size_t jaw, const JointPositions& joints) const;
  bool is_in_hand(Thing& thing, const ThingSighting& sighting, const JointPositions& joints) const;
  void take_back(Thing& thing, const ThingSighting& sighting);
  void show_evenly(Thing& thing, const Pose& before, const Pose& after) const;
  Pose model_pose(const Thing& thing) const { return world_->motion(thing.node).T_world_body; }
  Pose shown(const Thing& thing, const Pose& T_world_thing) const;
  JointPositions joints_now() const;
  JointPositions joints_at(RobotTime time) const;

  ThingFutureOptions options_;
  PartPoses robot_;
  std::vector<Thing> things_;
  std::unique_ptr<ThingWorld> world_;
  std::vector<std::string> joint_names_;
  struct Posture {
    RobotTime time;
    std::vector<double> joints;
  };
  std::deque<Posture> postures_;  // of each step, oldest first; never empty
  RobotTime now_;
  std::vector<int> opening_;  // of each jaw: the way it opened when it last held something
  std::uint64_t spell_ = 0;
  std::size_t failed_ = 0;
};

}  // namespace foresight

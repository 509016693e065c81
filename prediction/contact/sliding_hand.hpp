// The arm that is shown stops where it touches, and slides along with what is left of the hand's motion.
//
//        hand of the operator   x  ghost, with its reason
//                              /
//    arm --------------->.....x        the hand goes into the table, the tool along it
//                 ###################
//
// Surfaces are kept kSkin apart: what a camera at arm's length cannot tell from touching. The way of a picture is gone
// in parts. A part along which no two surfaces can meet is one that is shorter than the distances at its two ends
// together, whatever lies between; parts are chosen for that, and checked: nothing is passed through, at any speed.
// Close to a surface the tool goes to the nearest pose that the ways which are still open lead to (bounded_step).
//
// What comes out is to be shown, and a target for joints that goes into no contact; nothing here moves a robot.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "motion/robot_shape.hpp"
#include "prediction/contact/bounded_step.hpp"
#include "prediction/contact/contact_model.hpp"
#include "prediction/path_follower.hpp"

namespace foresight {

inline constexpr double kSkin = 0.001;        ///< m that the shown arm keeps from what it touches
inline constexpr double kLeastSkin = 0.0002;  ///< m that it never goes below
inline constexpr double kPushDepth = 0.015;   ///< m that it may be ahead of what it pushes

/// What keeps the shown hand from the operator's.
enum class GhostReason {
  none,         ///< nothing: it is there
  contact,      ///< parts touch
  gate,         ///< the robot's safety gate would stop there: its parts must stay farther apart than those that touch
  joint_speed,  ///< the rest as FollowReason
  joint_limit,
  singularity,
  out_of_reach,
  few_joints,
  other_branch,
  bad_target,
  unknown,  ///< where the scene or the robot is is not known
};
const char* name_of(GhostReason reason) noexcept;

/// Where the operator's hand is, for the display to draw where the arm is not.
struct GhostHand {
  bool shown = false;  ///< it is more than 2 mm or 1 degree from the shown tool
  Pose T_base_hand = Pose::Identity();
  GhostReason reason = GhostReason::none;
  std::string words;  ///< "arm_7 touches table"; empty without a reason
  double ahead = 0;   ///< m from the shown tool
  double turned = 0;  ///< rad from the shown tool
  /// Of contact: away from what is touched (unit, world), and how deep the hand is in it along that, m; else 0.
  Eigen::Vector3d out{0, 0, 0};
  double depth = 0;
};

struct HandStep {
  bool valid = false;             ///< else nothing moved, and ghost.words says why
  std::vector<double> positions;  ///< of all of the model's joints, at the end of the picture
  Pose T_base_tip = Pose::Identity();
  GhostHand ghost;
  int joint = -1;              ///< of the arm, that is the ghost's reason; -1: none in particular
  std::vector<Nearness> near;  ///< couples within kContactReach there, the nearest first
  int parts = 0;               ///< into which the way was cut
};

/// One thread. Allocates.
class SlidingHand {
 public:
  /// `joints`: as `model` was given them; `start`: their positions. All joints of the arm are among them. `gate`: the
  /// same robot's shape for the same joints, told its surroundings; null: only contact counts. All are borrowed.
  /// `T_world_base`: of what hands are relative to. Throws InputError at `where` for a joint of the arm that the model
  /// does not have, and where there is not one finite position for each joint.
  SlidingHand(ContactModel& model, const InverseKinematics& kinematics, const std::vector<std::string>& joints,
              std::span<const double> start, const Pose& T_world_base, RobotShape* gate, const std::string& where);

  /// One picture, `dt` seconds: the other joints (`others`: one for each of the model's joints; the arm's own do not
  /// count) go to their positions as far as nothing is in their way, then the tool goes for the hand. No joint of the
  /// arm goes farther than its velocity allows; how fast others go is up to who asks. Parts that touch already, as
  /// things do that came to the arm, get no deeper. A hand that is where the tool is moves nothing.
  HandStep step(const Pose& T_base_hand, std::span<const double> others, std::span<const Pose> T_world_node, double dt);

  /// One picture in which all joints go straight to `positions`, as far as nothing is in their way: nothing slides. How
  /// fast they go is up to who asks. The ghost is the tool as it would be there.
  HandStep go_to(std::span<const double> positions, std::span<const Pose> T_world_node);
  /// These parts of the model, of the scene, are loose: the arm pushes them aside. It may go into them from the side as
  /// deep as kPushDepth, as they are shown a moment later than what is asked for now; what gives way no more, as
  /// something stands behind it, stops it there. Pressed from above or lifted, they are as firm as anything.
  void may_push(std::vector<std::size_t> parts) { pushed_ = std::move(parts); }
  /// All joints are there instead: something else moved them. `positions` as `start`, the arm's put within its limits;
  /// false where there is not one finite number for each joint: then nothing changes.
  bool stand_at(std::span<const double> positions);

  std::span<const double> positions() const noexcept { return positions_; }

 private:
  struct Look;

  Look look(double within);
  bool gives_way(const Nearness& near, const Look& now) const;
  void settle_depths(Look& now, std::span<const Pose> T_world_node);
  double allowed(const Look& now, std::span<const double> change, double drift) const;
  bool go(const std::vector<double>& change, Look& now);
  bool clear(const Look& before, const Look& after, std::span<const double> change) const;
  double go_part(const std::vector<double>& change, double share, double least, Look& now);
  bool advance(const std::vector<double>& change, Look& now);
  void slide(const Pose& hand, double dt, const JointVector& start, Look& now);
  struct ClosedWays {
    std::vector<ClosedWay> ways;       // of what is near, in its order, then of the gate's couples
    std::vector<std::size_t> of_gate;  // these
  };
  ClosedWays closed_ways(const Look& now);
  void lean(const Look& now, const ClosedWays& closed);
  void lean_on_pushed(const Look& now);
  void blame(const Look& now);
  std::string touch_words(std::size_t couple) const;
  void settle_arm();
  bool fits(std::span<const double> positions) const;
  HandStep finish(Look& now);
  std::vector<double> spread(const JointVector& change) const;
  HandStep unknown(const Pose& hand, std::string why) const;
  GhostHand ghost(const Pose& hand, GhostReason otherwise) const;

  ContactModel& model_;
  const InverseKinematics& kinematics_;
  Pose T_world_base_;
  RobotShape* gate_;
  PathFollower follower_;
  std::vector<std::size_t> arm_;  // index of each of the arm's joints
  std::vector<double> positions_;
  std::vector<std::size_t> pushed_;       // parts that are loose
  bool pushes_ = false;                   // it is the arm that moves: jaws press instead
  std::map<std::size_t, double> depths_;  // that couples which touched already may have
  std::vector<Pose> nodes_;               // as of the last picture
  std::size_t arrangement_ = 0;
  int parts_ = 0;
  GhostReason leans_ = GhostReason::none;  // and on what:
  Eigen::Vector3d out_{0, 0, 0};
  std::string words_;
};

}  // namespace foresight

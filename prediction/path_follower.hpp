// Moves an arm so that its tool follows a target that is given anew every cycle, as a hand does.
//
//   target 1 --- target 2 --- target 3 ...           the hand goes straight towards the newest target, as far as the
//       \            \                               joints' limits and velocities let it within the cycle
//        hand ------- hand ------ hand ...
//
// Joints never jump: every position of a cycle lies within velocity * dt of the one before, whatever the target does,
// and no branch is left but by moving through what lies between. Where the hand cannot keep up (a joint at its velocity
// or limit, a singularity, the end of its reach) it slows down, stays on its line while that is possible, and says why.
// Arms with more joints than the task needs use the freedom to stay away from limits and singularities, but only while
// the hand moves: a target where the hand is moves nothing, bit for bit. Arms with fewer follow the hand's place, and
// turn with it as far as that leaves their joints free to.
#pragma once

#include <optional>

#include "prediction/inverse_kinematics.hpp"

namespace foresight {

/// What keeps the hand from its target.
enum class FollowReason {
  none,          ///< it is there
  joint_speed,   ///< a joint moves as fast as it may
  joint_limit,   ///< a joint stands at its limit
  singularity,   ///< the arm can hardly move the hand in some direction (stretched, folded, axes in line)
  out_of_reach,  ///< no joints within limits bring it there: it goes to the nearest pose
  few_joints,    ///< its place is reached, but the arm has too few joints to turn the hand so
  other_branch,  ///< only joints far from the present ones bring it there: the arm would have to be brought round
  contact,       ///< parts would touch, or come too close; only where somebody looks out for that (prediction/contact)
  unknown,       ///< so looked out for, but what is around the arm is not known: it stands
  bad_target,    ///< not a finite rigid pose, or a cycle of no time: it stands
};

const char* name_of(FollowReason reason) noexcept;

struct FollowOptions {
  double singular = 0.06;  ///< least mobility of the hand (m / length or rad, per rad) below which that is the reason
  double freedom = 0.5;    ///< largest share of its own motion that the arm adds to get away from limits
  double way_round = 1.2;  ///< rad: how far joints may go to leave a place where the hand is stuck
};

struct FollowStep {
  JointVector q;                       ///< positions for the end of the cycle
  Pose T_base_tip = Pose::Identity();  ///< the hand then
  FollowReason reason = FollowReason::none;
  int joint = -1;             ///< the joint that is the reason; -1: none in particular
  bool on_line = true;        ///< the hand stayed on the straight line to its target, to 1e-9
  double progress = 1;        ///< share of the way to the target that this cycle went, at most 1
  double position_error = 0;  ///< m left
  double rotation_error = 0;  ///< rad left
};

/// One thread. step() neither throws nor allocates.
class PathFollower {
 public:
  /// `kinematics` must outlive the follower. `start`: one position per joint; put within the limits.
  PathFollower(const InverseKinematics& kinematics, const JointVector& start, const FollowOptions& options = {});

  const JointVector& joints() const noexcept { return q_; }
  const Pose& hand() const noexcept { return hand_; }
  /// The arm is there instead, wherever it was: something else moved it. `q` as `start`.
  void stand_at(const JointVector& q) noexcept;
  /// The cycle of `dt` seconds in which the hand goes for `T_base_tip`.
  FollowStep step(const Pose& T_base_tip, double dt) noexcept;

 private:
  struct Cycle;
  bool reach(const Pose& pose, const Cycle& cycle, JointVector& q) const noexcept;
  bool reach_place(const DescentGoal& goal, const Cycle& cycle, JointVector& q) const noexcept;
  void name_turn_left(const Pose& target, FollowStep& step) const noexcept;
  double reach_part(const Pose& target, const Cycle& cycle, JointVector& q) const noexcept;
  JointVector freedom(const TipChange& change) const noexcept;
  bool way_round(const Pose& target, const Cycle& cycle, JointVector& q, FollowReason& why) noexcept;
  FollowStep finish(const Pose& target, const Cycle& cycle, const JointVector& q) noexcept;
  void name_reason(const Cycle& cycle, const JointVector& before, FollowStep& step) const noexcept;

  const InverseKinematics& kinematics_;
  const ArmChain& chain_;
  FollowOptions options_;
  JointVector q_;
  Pose hand_;
  std::optional<JointVector> detour_;  ///< joints on the way to which the hand may leave its line
  Pose detour_target_ = Pose::Identity();
  std::optional<Pose> stuck_target_;  ///< for which there was no way round
  FollowReason stuck_why_ = FollowReason::none;
};

}  // namespace foresight

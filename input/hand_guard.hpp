// Who keeps the arm from touching what it must not: asked before a hand's set-points are made.
//
//   hand --> HandControl --target--> HandGuard --how far the arm may go--> set-points
//
// What is sent is then what is shown. The robot's own safety gate remains the authority.
#pragma once

#include "motion/gate_options.hpp"
#include "prediction/path_follower.hpp"

namespace foresight {

/// One thread. Positions are of all of the robot's joints in its order, rad or m, finite.
class HandGuard {
 public:
  virtual ~HandGuard() = default;
  /// The joints stand at `from`, and the tool goes for `T_base_target` within `dt` seconds (> 0). `q`: where the arm's
  /// joints get to, no farther than their velocities allow; where they stood, with `unknown` as the reason, where it
  /// cannot tell.
  virtual FollowStep step(const JointValues& from, const Pose& T_base_target, double dt) noexcept = 0;
  /// The joints go straight from `from` to `to`. `q`: where the arm's get to on that way.
  virtual FollowStep go(const JointValues& from, const JointValues& to) noexcept = 0;
};

}  // namespace foresight

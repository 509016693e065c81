// Inverse kinematics step by step: damped least squares within limits.
//
//   dq = J' (J J' + mu I)^-1 e,     mu = |e|^2 / 2
//
// (Wampler 1986, Nakamura and Hanafusa 1986; a damping that falls with the error makes it end like Newton's method and
// never divide by zero: Sugihara, Solvability-unconcerned inverse kinematics by the Levenberg-Marquardt method, IEEE
// T-RO 27(5), 2011.) A joint that would leave its limits stays on it, and the step is made again with the others alone.
#pragma once

#include "prediction/arm_chain.hpp"

namespace foresight {

/// What a descent is to do.
struct DescentGoal {
  Pose T_base_tip = Pose::Identity();
  bool position_only = false;
  double length = 1;  ///< m that weigh as much as one rad
};

struct DescentLimits {
  JointVector lower, upper;  ///< finite or infinite
  int steps = 30;
  double tolerance = 1e-11;   ///< ends where the remaining error (rad, m / length) is no larger
  bool give_up_early = true;  ///< where the error hardly falls any more; false: only where it stands still
};

struct DescentEnd {
  JointVector q;
  double error = 0;  ///< |e|: rad, and m / length
  int steps = 0;
};

/// The weighted difference between the tip and its goal. Rotation is 0 where only the position counts.
Vector6 weighted_error(const Pose& T_base_tip, const DescentGoal& goal) noexcept;

/// From `q` (within the limits) towards the goal; never returns worse than it was given. Neither throws nor allocates;
/// any thread.
DescentEnd descend(const ArmChain& chain, const DescentGoal& goal, const DescentLimits& limits,
                   const JointVector& q) noexcept;

/// For arms that cannot choose their tip's orientation: from `q`, where the goal's position is reached, on to where the
/// tip is turned to the goal as nearly as the joints and `limits` let it, with the position as exact as
/// `limits.tolerance`. Returns `q` where nothing is gained. Neither throws nor allocates; any thread.
JointVector turned_to_goal(const ArmChain& chain, const DescentGoal& goal, const DescentLimits& limits,
                           const JointVector& q) noexcept;

/// One step: the joints' changes that bring the error e (weighted) towards 0 with damping mu > 0, plus `wish`, as far
/// as that changes nothing at the tip. `q` + the changes stay within the limits. `held` gets true for joints that a
/// limit stopped. `change` is weighted in place.
JointVector damped_step(const ArmChain& chain, const DescentGoal& goal, const TipChange& change, const Vector6& e,
                        double mu, const JointVector& q, const JointVector& lower, const JointVector& upper,
                        const JointVector* wish = nullptr, std::array<bool, kMostArmJoints>* held = nullptr) noexcept;

/// The smallest singular value of the weighted tip change: how far the hand moves (rad, m / length) per rad of the
/// joints in the direction in which it moves least.
double least_mobility(const ArmChain& chain, const DescentGoal& goal, const TipChange& change) noexcept;

}  // namespace foresight

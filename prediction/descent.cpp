#include "prediction/descent.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>

namespace foresight {
namespace {

using Matrix6 = Eigen::Matrix<double, 6, 6>;

constexpr double kLongestStep = 1;      // rad or m in one step: farther the tangent says nothing
constexpr double kPlaceOverTurn = 100;  // how much heavier the position weighs while the tip is turned
constexpr double kTurnDamping = 1e-6;
constexpr int kPlaceSteps = 10;      // back to the position after a turn
constexpr double kLeastTurn = 1e-9;  // rad that must be gained
constexpr int kTurnHalvings = 3;     // of a step that gains nothing

Vector6 weights(const DescentGoal& goal) {
  Vector6 w;
  w.head<3>().setConstant(1 / goal.length);
  w.tail<3>().setConstant(goal.position_only ? 0.0 : 1.0);
  return w;
}

}  // namespace

Vector6 weighted_error(const Pose& T_base_tip, const DescentGoal& goal) noexcept {
  return pose_difference(T_base_tip, goal.T_base_tip).cwiseProduct(weights(goal));
}

JointVector damped_step(const ArmChain& chain, const DescentGoal& goal, const TipChange& change, const Vector6& e,
                        double mu, const JointVector& q, const JointVector& lower, const JointVector& upper,
                        const JointVector* wish, std::array<bool, kMostArmJoints>* held) noexcept {
  const std::size_t n = chain.size();
  const Vector6 w = weights(goal);
  std::array<bool, kMostArmJoints> fixed{};
  JointVector step = JointVector::Zero(static_cast<Eigen::Index>(n));
  // Each round fixes at least one joint more, on its limit.
  for (std::size_t round = 0; round <= n; ++round) {
    Matrix6 A = mu * Matrix6::Identity();
    Vector6 rest = e;
    for (std::size_t i = 0; i < n; ++i) {
      const auto at = static_cast<Eigen::Index>(i);
      const Vector6 column = change[i].cwiseProduct(w);
      if (fixed[i])
        rest -= step[at] * column;
      else
        A.noalias() += column * column.transpose();
      if (!fixed[i] && wish) rest -= (*wish)[at] * column;
    }
    const Vector6 y = A.llt().solve(rest);
    bool done = true;
    for (std::size_t i = 0; i < n; ++i) {
      if (fixed[i]) continue;
      const auto at = static_cast<Eigen::Index>(i);
      const double wanted = change[i].cwiseProduct(w).dot(y) + (wish ? (*wish)[at] : 0.0);
      step[at] = std::clamp(wanted, lower[at] - q[at], upper[at] - q[at]);
      if (step[at] == wanted) continue;
      if (wanted != wanted) step[at] = 0;
      fixed[i] = true;
      done = false;
    }
    if (done) break;
  }
  if (held) *held = fixed;
  return step;
}

double least_mobility(const ArmChain& chain, const DescentGoal& goal, const TipChange& change) noexcept {
  const Vector6 w = weights(goal);
  Matrix6 A = Matrix6::Zero();
  for (std::size_t i = 0; i < chain.size(); ++i) {
    const Vector6 column = change[i].cwiseProduct(w);
    A.noalias() += column * column.transpose();
  }
  const double least =
      goal.position_only
          ? Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(A.topLeftCorner<3, 3>(), Eigen::EigenvaluesOnly)
                .eigenvalues()[0]
          : Eigen::SelfAdjointEigenSolver<Matrix6>(A, Eigen::EigenvaluesOnly).eigenvalues()[0];
  return std::sqrt(std::max(least, 0.0));
}

DescentEnd descend(const ArmChain& chain, const DescentGoal& goal, const DescentLimits& limits,
                   const JointVector& from) noexcept {
  TipChange change, next_change;
  DescentEnd at{from, 0, 0};
  Vector6 e = weighted_error(chain.tip_pose(at.q, change), goal);
  at.error = e.norm();
  double stiffness = 1, error_then = at.error;
  int hardly = 0;
  while (at.steps < limits.steps && at.error > limits.tolerance) {
    ++at.steps;
    const double mu = 0.5 * stiffness * at.error * at.error + 1e-14;
    JointVector dq = damped_step(chain, goal, change, e, mu, at.q, limits.lower, limits.upper);
    const double longest = dq.cwiseAbs().maxCoeff();
    if (!(longest > 0)) break;
    if (longest > kLongestStep) dq *= kLongestStep / longest;
    // Rounding of q + (limit - q) must not leave the limit.
    const JointVector q = (at.q + dq).cwiseMax(limits.lower).cwiseMin(limits.upper);
    const Vector6 e_next = weighted_error(chain.tip_pose(q, next_change), goal);
    const double error = e_next.norm();
    if (!(error < at.error)) {
      stiffness *= 6;
      if (stiffness > 1e8 || error != error) break;
      continue;
    }
    hardly = error > (1 - 1e-10) * at.error ? hardly + 1 : 0;
    stiffness = std::max(stiffness * 0.3, 1e-6);
    at.q = q;
    at.error = error;
    e = e_next;
    change = next_change;
    if (hardly == 3) break;
    if (limits.give_up_early && at.steps % 6 == 0) {
      if (at.error > 0.7 * error_then) break;
      error_then = at.error;
    }
  }
  return at;
}

JointVector turned_to_goal(const ArmChain& chain, const DescentGoal& goal, const DescentLimits& limits,
                           const JointVector& from) noexcept {
  DescentGoal place = goal, both = goal;
  place.position_only = true;
  both.position_only = false;
  both.length = goal.length / kPlaceOverTurn;
  DescentLimits placing = limits;
  placing.steps = kPlaceSteps;
  placing.give_up_early = false;
  TipChange change;
  JointVector q = from;
  Vector6 e = weighted_error(chain.tip_pose(q, change), both);
  for (int step = 0; step < limits.steps; ++step) {
    JointVector dq = damped_step(chain, both, change, e, kTurnDamping, q, limits.lower, limits.upper);
    bool gained = false;
    for (int k = 0; k < kTurnHalvings && !gained; ++k, dq *= 0.5) {
      const JointVector there = (q + dq).cwiseMax(limits.lower).cwiseMin(limits.upper);
      const DescentEnd end = descend(chain, place, placing, there);
      TipChange change_there;
      const Vector6 left = weighted_error(chain.tip_pose(end.q, change_there), both);
      gained = end.error <= limits.tolerance && left.tail<3>().norm() < e.tail<3>().norm() - kLeastTurn;
      if (!gained) continue;
      q = end.q;
      e = left;
      change = change_there;
    }
    if (!gained) break;
  }
  return q;
}

}  // namespace foresight

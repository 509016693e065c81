// Least squares over one pose and a few numbers beside it, for problems of many residuals and few unknowns that are
// solved again and again.
//
//   unknowns x: T = base * to_motion(x_0..5), then `Extra` numbers
//   minimises   sum of half squares, or of a robust loss + 1/2 x^T prior x
//
// A problem adds up its normal equations in place: whatever the number of residuals, all that is kept are matrices of
// the unknowns' size. Levenberg and Marquardt's method, by Ceres' TinySolver, which is given the equations' square
// root as its Jacobian. A robust loss takes part by its weights (iteratively reweighted least squares).
#pragma once

#include <functional>

#include "calibration/camera/twist.hpp"

namespace foresight {

/// Where a problem is evaluated, and what was found.
template <int Extra>
struct PoseEstimate {
  Pose T = Pose::Identity();
  Eigen::Matrix<double, Extra, 1> extra = Eigen::Matrix<double, Extra, 1>::Zero();
};

/// Of a small motion of T in its own frame (T to_motion(step)), then of the extra numbers.
template <int Extra>
struct PoseEquations {
  static constexpr int kSize = 6 + Extra;
  Eigen::Matrix<double, kSize, kSize> H = Eigen::Matrix<double, kSize, kSize>::Zero();  ///< sum of w J^T J
  Eigen::Matrix<double, kSize, 1> g = Eigen::Matrix<double, kSize, 1>::Zero();          ///< sum of w J^T r
  double cost = 0;  ///< half the squares, or the loss; at least half the sum of w r^2
};

/// Adds to `equations`, which is zero: the cost always, H and g where `derivatives`. False where nothing can be said
/// there (a point behind the camera).
template <int Extra>
using PoseProblem =
    std::function<bool(const PoseEstimate<Extra>& at, bool derivatives, PoseEquations<Extra>& equations)>;

template <int Extra>
struct PoseSolverOptions {
  Pose base = Pose::Identity();  ///< where the prior has its mean
  /// Information about x; zero: none.
  Eigen::Matrix<double, 6 + Extra, 6 + Extra> prior = Eigen::Matrix<double, 6 + Extra, 6 + Extra>::Zero();
  int most_iterations = 20;
  /// The solver ends with a step of the pose for which twist^T step_metric twist < 1.
  Matrix6d step_metric = 1e18 * Matrix6d::Identity();
};

template <int Extra>
struct PoseSolution {
  PoseEstimate<Extra> at;
  PoseEquations<Extra> equations;  ///< with the prior, where they were last formed: before the last step
  bool usable = false;             ///< false where the problem said nothing at the start
};

/// From `start`. Allocates nothing. Any thread. Of 0 and 2 extra numbers.
template <int Extra>
PoseSolution<Extra> solve_pose(const PoseEstimate<Extra>& start, const PoseProblem<Extra>& problem,
                               const PoseSolverOptions<Extra>& options);

template <>
PoseSolution<0> solve_pose(const PoseEstimate<0>&, const PoseProblem<0>&, const PoseSolverOptions<0>&);
template <>
PoseSolution<2> solve_pose(const PoseEstimate<2>&, const PoseProblem<2>&, const PoseSolverOptions<2>&);

}  // namespace foresight

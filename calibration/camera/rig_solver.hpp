// Bundle adjustment of one camera or a pair over board views: lenses, T_left_right, board warp and a
// board pose for each view, all at once. The residuals and the gauge: docs/calibration/lens.md.
#pragma once

#include <Eigen/SparseCore>

#include "calibration/camera/rig.hpp"

namespace foresight {

struct RigSolverOptions {
  bool warp = true;  ///< estimates the board's warp
  /// A corner is an outlier where its error is larger than so many standard deviations, found from
  /// the median of all errors, so that the outliers themselves do not count. Of Gaussian errors 5
  /// would take one point in 270,000.
  double reject_sigmas = 5;
  /// Beyond so many of them a corner pulls less and less (Cauchy's loss); 0: plain least squares.
  double loss_sigmas = 4;
  int most_rounds = 8;        ///< of solving and rejecting
  int most_iterations = 100;  ///< of each round
};

struct RejectedCorner {
  std::size_t view = 0;  ///< into RigViews::views
  int camera = 0;
  int index = 0;  ///< of the board's point
  double error_px = 0;
};

/// An estimate, and before the solution the start for one.
struct RigSolution {
  CameraRig rig;
  std::vector<Pose> T_left_board;  ///< of every view
  std::vector<RejectedCorner> rejected;
  double rms_px = 0;    ///< sqrt(mean(dx^2 + dy^2)) over the accepted corners
  double noise_px = 0;  ///< of a coordinate of a corner of median sigma_px, by the residuals and degrees of freedom
  int points = 0;       ///< accepted
  int parameters = 0;   ///< free
  bool converged = false;
};

/// The boards at `indices`, in their order, as a start: nothing is rejected yet.
RigSolution subset(const RigSolution& all, const std::vector<std::size_t>& indices);

/// Solves from `start`, whose rig names the lens models and sizes. Its `rejected` is where the
/// first round begins. Throws InputError where the start puts a board behind a camera.
RigSolution solve_rig(const RigViews& views, const RigSolution& start, const RigSolverOptions& options);

/// Pixel error of every corner, predicted less measured, as [view][camera][corner].
using RigErrors = std::vector<std::array<std::vector<Eigen::Vector2d>, 2>>;
RigErrors rig_errors(const RigViews& views, const RigSolution& solution);

/// A corner whose weighted error is larger than `px` counts as an outlier.
struct OutlierBound {
  double px = 0;
  double sigma_px = 1;  ///< the median one

  /// The error as if the corner were of median sigma_px.
  double weighted_px(const Corner& corner, double error_px) const { return error_px * sigma_px / corner.sigma_px; }
};

/// `reject_sigmas` as in RigSolverOptions: times the deviation that the median of all errors has; at
/// least 0.02 px.
OutlierBound outlier_bound(const RigViews& views, const RigErrors& errors, double reject_sigmas);

/// What the accepted corners say about the parameters: J^T W J at `solution`, symmetric, W in units of
/// the noise of a corner of median sigma_px. Rows in this order: each camera's free lens parameters;
/// T_left_right (6, of a pair); warp (2, where estimated); the pose of each view (6). Motions as
/// rigid_motion.hpp perturbs them: half the rotation vector from the left, then the shift.
struct RigInformation {
  Eigen::SparseMatrix<double> matrix;
  std::array<int, 2> lens_at{};
  int motion_at = -1;  ///< -1: one camera
  int warp_at = -1;    ///< -1: not estimated
  int poses_at = 0;
};
RigInformation rig_information(const RigViews& views, const RigSolution& solution, bool warp);

}  // namespace foresight

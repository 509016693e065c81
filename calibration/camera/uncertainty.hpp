// How much a calibration would move if the corners had been measured again.
//
// The corners' noise is carried to all parameters by the normal matrix, and from there to the pixel
// where a point that stands still in the world is seen. The boards are what stands still: a point at
// `pixel` is fixed to every board, these move with their poses, and it is seen again where their mean
// takes it. Otherwise a turn of the camera that the lens makes good for would count as an error. The
// method is that of mrcal 2.2, "mean-pcam" (D. Kogan, documentation of mrcal, Projection uncertainty).
#pragma once

#include <memory>

#include "calibration/camera/rig_solver.hpp"

namespace foresight {

/// Over an image: sigma in px along the worst direction.
struct UncertaintyMap {
  Eigen::MatrixXd px;  ///< rows and columns evenly from the first to the last pixel; NaN: the lens does not see there
  double centre_px = 0;
  double median_px = 0;
  double p90_px = 0;
  double worst_corner_px = 0;  ///< of the four
};

class RigUncertainty {
 public:
  /// Of a solution with these views and option. Throws nothing; see usable().
  RigUncertainty(const RigViews& views, const RigSolution& solution, bool warp);
  ~RigUncertainty();
  RigUncertainty(RigUncertainty&&) noexcept;
  RigUncertainty& operator=(RigUncertainty&&) noexcept;

  /// Whether the normal matrix has an inverse.
  bool usable() const;

  /// `distance_m`: of the point; none: infinitely far.
  UncertaintyMap map(int camera, std::optional<double> distance_m, int cols = 32, int rows = 24) const;

  /// Sigma in px at `pixel` along the worst direction; NaN where the lens does not see.
  double at(int camera, const Eigen::Vector2d& pixel, std::optional<double> distance_m) const;

  /// Standard deviations of the lens parameters of a camera, in the order of LensParameters.
  LensParameters lens_sigma(int camera) const;
  double baseline_sigma_m() const;
  double rotation_sigma_rad() const;  ///< of T_left_right, the largest of any axis
  Eigen::Vector2d warp_sigma_m() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace foresight

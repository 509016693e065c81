#include "calibration/registration/projection_slope.hpp"

namespace foresight {

std::optional<Eigen::Matrix<double, 2, 3>> projection_slope(const Lens& lens, const Eigen::Vector3d& p_camera) {
  Eigen::Matrix<double, 2, 3> slope;
  const double step = 1e-4 * p_camera.norm();
  for (int axis = 0; axis < 3; ++axis) {
    const Eigen::Vector3d d = step * Eigen::Vector3d::Unit(axis);
    const auto after = lens.project(p_camera + d), before = lens.project(p_camera - d);
    if (!after || !before) return std::nullopt;
    slope.col(axis) = (*after - *before) / (2 * step);
  }
  return slope;
}

}  // namespace foresight

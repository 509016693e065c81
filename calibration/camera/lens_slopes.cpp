#include "calibration/camera/lens_slopes.hpp"

namespace foresight {

bool project_with_slopes(Distortion distortion, const double* lens, const Eigen::Vector3d& p_camera,
                         Eigen::Vector2d& pixel, LensSlopes& slopes) {
  using Jet = ceres::Jet<double, kLensParameters + 3>;
  std::array<Jet, kLensParameters> l;
  for (int i = 0; i < kLensParameters; ++i) l[static_cast<std::size_t>(i)] = Jet(lens[i], i);
  Eigen::Matrix<Jet, 3, 1> p;
  for (int i = 0; i < 3; ++i) p[i] = Jet(p_camera[i], kLensParameters + i);
  Eigen::Matrix<Jet, 2, 1> seen;
  if (!project(distortion, l.data(), p, seen)) return false;
  for (int row = 0; row < 2; ++row) {
    pixel[row] = seen[row].a;
    slopes.lens.row(row) = seen[row].v.head<kLensParameters>().transpose();
    slopes.point.row(row) = seen[row].v.tail<3>().transpose();
  }
  return true;
}

}  // namespace foresight

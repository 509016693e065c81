// Derivatives of a lens's projection, compiled once: a residual that is differentiated by many parameters puts them
// into the chain rule, instead of taking all of these parameters through the lens model.
#pragma once

#include <ceres/jet.h>

#include <Eigen/Core>

#include "calibration/camera/lens_projection.hpp"

namespace foresight {

struct LensSlopes {
  Eigen::Matrix<double, 2, kLensParameters> lens;  ///< d pixel / d LensParameters
  Eigen::Matrix<double, 2, 3> point;               ///< d pixel / d p_camera, px per metre
};

/// As project(), with its derivatives.
bool project_with_slopes(Distortion distortion, const double* lens, const Eigen::Vector3d& p_camera,
                         Eigen::Vector2d& pixel, LensSlopes& slopes);

/// As project(), for residuals that Ceres differentiates; the lens is known. `wanted`: filled where given.
inline bool project_by_slopes(Distortion distortion, const LensParameters& lens, const Eigen::Vector3d& p_camera,
                              Eigen::Vector2d& pixel) {
  return project(distortion, lens.data(), p_camera, pixel);
}

template <int N>
bool project_by_slopes(Distortion distortion, const LensParameters& lens,
                       const Eigen::Matrix<ceres::Jet<double, N>, 3, 1>& p_camera,
                       Eigen::Matrix<ceres::Jet<double, N>, 2, 1>& pixel, LensSlopes* wanted = nullptr) {
  LensSlopes own;
  LensSlopes& slopes = wanted ? *wanted : own;
  Eigen::Vector2d at;
  if (!project_with_slopes(distortion, lens.data(), {p_camera[0].a, p_camera[1].a, p_camera[2].a}, at, slopes))
    return false;
  for (int row = 0; row < 2; ++row) {
    pixel[row].a = at[row];
    pixel[row].v = slopes.point(row, 0) * p_camera[0].v + slopes.point(row, 1) * p_camera[1].v +
                   slopes.point(row, 2) * p_camera[2].v;
  }
  return true;
}

/// The same where the lens is estimated.
inline bool project_by_slopes(Distortion distortion, const double* lens, const Eigen::Vector3d& p_camera,
                              Eigen::Vector2d& pixel) {
  return project(distortion, lens, p_camera, pixel);
}

template <int N>
bool project_by_slopes(Distortion distortion, const ceres::Jet<double, N>* lens,
                       const Eigen::Matrix<ceres::Jet<double, N>, 3, 1>& p_camera,
                       Eigen::Matrix<ceres::Jet<double, N>, 2, 1>& pixel) {
  LensParameters values;
  for (std::size_t i = 0; i < values.size(); ++i) values[i] = lens[i].a;
  LensSlopes slopes;
  if (!project_by_slopes(distortion, values, p_camera, pixel, &slopes)) return false;
  for (int row = 0; row < 2; ++row)
    for (int i = 0; i < kLensParameters; ++i) pixel[row].v += slopes.lens(row, i) * lens[i].v;
  return true;
}

}  // namespace foresight

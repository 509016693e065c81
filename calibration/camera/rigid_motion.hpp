// Rigid motions as Ceres parameters: seven numbers, qx qy qz qw tx ty tz (Eigen's order), on the
// product of the unit quaternions and R^3.
#pragma once

#include <ceres/manifold.h>
#include <ceres/product_manifold.h>

#include <Eigen/Geometry>
#include <array>

#include "scene/scene_model.hpp"

namespace foresight {

using MotionParameters = std::array<double, 7>;

inline MotionParameters to_parameters(const Pose& T) {
  const Eigen::Quaterniond q(T.linear());
  return {q.x(), q.y(), q.z(), q.w(), T.translation().x(), T.translation().y(), T.translation().z()};
}

inline Pose to_pose(const MotionParameters& m) {
  Pose T = Pose::Identity();
  T.linear() = Eigen::Quaterniond(m[3], m[0], m[1], m[2]).normalized().toRotationMatrix();
  T.translation() << m[4], m[5], m[6];
  return T;
}

/// `m * p`: rotates and moves a point.
template <typename T>
Eigen::Matrix<T, 3, 1> transform(const T* m, const Eigen::Matrix<T, 3, 1>& p) {
  return Eigen::Map<const Eigen::Quaternion<T>>(m) * p + Eigen::Map<const Eigen::Matrix<T, 3, 1>>(m + 4);
}

/// `m^-1 * p`.
template <typename T>
Eigen::Matrix<T, 3, 1> inverse_transform(const T* m, const Eigen::Matrix<T, 3, 1>& p) {
  const Eigen::Matrix<T, 3, 1> moved = p - Eigen::Map<const Eigen::Matrix<T, 3, 1>>(m + 4);
  return Eigen::Map<const Eigen::Quaternion<T>>(m).conjugate() * moved;
}

/// Six degrees of freedom: rotation first, then translation. The problem takes ownership.
inline ceres::Manifold* motion_manifold() {
  return new ceres::ProductManifold<ceres::EigenQuaternionManifold, ceres::EuclideanManifold<3>>();
}

}  // namespace foresight

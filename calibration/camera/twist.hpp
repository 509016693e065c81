// Small rigid motions as six numbers: rotation vector (rad) first, then translation (m).
#pragma once

#include <Eigen/Geometry>

#include "scene/scene_model.hpp"

namespace foresight {

using Vector6d = Eigen::Matrix<double, 6, 1>;
using Matrix6d = Eigen::Matrix<double, 6, 6>;

/// Rotation and translation are independent (no screw motion), which is all that small motions need.
inline Pose to_motion(const Vector6d& twist) {
  const Eigen::Vector3d w = twist.head<3>();
  Pose T = Pose::Identity();
  T.translation() = twist.tail<3>();
  const double angle = w.norm();
  if (angle > 0) T.linear() = Eigen::AngleAxisd(angle, w / angle).toRotationMatrix();
  return T;
}

/// Inverse of to_motion() for angles below pi.
inline Vector6d to_twist(const Pose& T) {
  const Eigen::AngleAxisd rotation(T.linear());
  Vector6d twist;
  twist << rotation.angle() * rotation.axis(), T.translation();
  return twist;
}

}  // namespace foresight

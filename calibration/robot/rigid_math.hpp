// Small steps of rigid motions, and means of many poses.
#pragma once

#include <Eigen/Geometry>
#include <span>
#include <vector>

#include "calibration/camera/twist.hpp"
#include "common/statistics.hpp"
#include "scene/scene_model.hpp"

namespace foresight {

/// Rotation by the vector's direction and length.
Eigen::Matrix3d rotation_of(const Eigen::Vector3d& rotation_vector);

/// The inverse, length in [0, pi].
Eigen::Vector3d rotation_vector(const Eigen::Matrix3d& R);

/// `T` moved by `step` (twist.hpp) in its own frame: R Exp(w), t + R v.
Pose moved(const Pose& T, const Vector6d& step);

/// The step with moved(from, step) = to.
Vector6d step_between(const Pose& from, const Pose& to);

/// How far two poses are from one another, m: a radian counts as much as 0.1 m.
double misfit_m(const Pose& one, const Pose& other);

/// Chordal mean rotation and median position; at least one pose.
Pose typical_pose(std::span<const Pose> poses);

}  // namespace foresight

// Small steps of rigid motions, and means of many poses.
#pragma once

#include <Eigen/Geometry>
#include <span>
#include <vector>

#include "common/statistics.hpp"
#include "scene/scene_model.hpp"

namespace foresight {

/// Rotation vector (rad) and translation (m) of a small motion.
using Vector6 = Eigen::Matrix<double, 6, 1>;

/// Rotation by the vector's direction and length.
Eigen::Matrix3d rotation_of(const Eigen::Vector3d& rotation_vector);

/// The inverse, length in [0, pi].
Eigen::Vector3d rotation_vector(const Eigen::Matrix3d& R);

/// `T` moved by `step` in its own frame: R Exp(w), t + R v.
Pose moved(const Pose& T, const Vector6& step);

/// The step with moved(from, step) = to.
Vector6 step_between(const Pose& from, const Pose& to);

/// Chordal mean rotation and median position; at least one pose.
Pose typical_pose(std::span<const Pose> poses);

/// 1.4826 times the median absolute value: the standard deviation where most values are normal.
double robust_sigma(std::vector<double> values);

}  // namespace foresight

#include "calibration/robot/rigid_math.hpp"

#include <algorithm>

#include "common/rotation.hpp"

namespace foresight {

Eigen::Matrix3d rotation_of(const Eigen::Vector3d& rotation_vector) {
  const double angle = rotation_vector.norm();
  if (angle == 0) return Eigen::Matrix3d::Identity();
  return Eigen::AngleAxisd(angle, rotation_vector / angle).toRotationMatrix();
}

Eigen::Vector3d rotation_vector(const Eigen::Matrix3d& R) {
  const Eigen::AngleAxisd turn(R);
  return turn.angle() * turn.axis();
}

Pose moved(const Pose& T, const Vector6d& step) {
  return T * to_motion(step);
}

Vector6d step_between(const Pose& from, const Pose& to) {
  return to_twist(from.inverse() * to);
}

double misfit_m(const Pose& one, const Pose& other) {
  constexpr double kLever = 0.1;  // m
  const double turn = rotation_vector(one.linear().transpose() * other.linear()).norm();
  return (one.translation() - other.translation()).norm() + kLever * turn;
}

Pose typical_pose(std::span<const Pose> poses) {
  Eigen::Matrix3d sum = Eigen::Matrix3d::Zero();
  std::array<std::vector<double>, 3> t;
  for (const Pose& pose : poses) {
    sum += pose.linear();
    for (int i = 0; i < 3; ++i) t[static_cast<std::size_t>(i)].push_back(pose.translation()[i]);
  }
  Pose out = Pose::Identity();
  out.linear() = nearest_rotation(sum);
  out.translation() = Eigen::Vector3d(median(t[0]), median(t[1]), median(t[2]));
  return out;
}

}  // namespace foresight

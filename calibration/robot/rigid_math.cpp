#include "calibration/robot/rigid_math.hpp"

#include <Eigen/SVD>
#include <algorithm>

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

Pose moved(const Pose& T, const Vector6& step) {
  Pose out = Pose::Identity();
  out.linear() = T.linear() * rotation_of(step.head<3>());
  out.translation() = T.translation() + T.linear() * step.tail<3>();
  return out;
}

Vector6 step_between(const Pose& from, const Pose& to) {
  Vector6 step;
  step.head<3>() = rotation_vector(from.linear().transpose() * to.linear());
  step.tail<3>() = from.linear().transpose() * (to.translation() - from.translation());
  return step;
}

Pose typical_pose(std::span<const Pose> poses) {
  Eigen::Matrix3d sum = Eigen::Matrix3d::Zero();
  std::array<std::vector<double>, 3> t;
  for (const Pose& pose : poses) {
    sum += pose.linear();
    for (int i = 0; i < 3; ++i) t[static_cast<std::size_t>(i)].push_back(pose.translation()[i]);
  }
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(sum, Eigen::ComputeFullU | Eigen::ComputeFullV);
  Eigen::Matrix3d flip = Eigen::Matrix3d::Identity();
  flip(2, 2) = (svd.matrixU() * svd.matrixV().transpose()).determinant();
  Pose out = Pose::Identity();
  out.linear() = svd.matrixU() * flip * svd.matrixV().transpose();
  out.translation() = Eigen::Vector3d(median(t[0]), median(t[1]), median(t[2]));
  return out;
}

double robust_sigma(std::vector<double> values) {
  for (double& value : values) value = std::abs(value);
  return 1.4826 * median(std::move(values));
}

}  // namespace foresight

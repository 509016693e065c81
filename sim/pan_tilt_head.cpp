#include "sim/pan_tilt_head.hpp"

namespace foresight::sim {

Pose T_world_head_foot() {
  Pose pose = Pose::Identity();
  pose.translate(Eigen::Vector3d(-0.82, 0.04, 0.40));
  return pose;
}

Pose T_world_head_left(const PanTilt& shafts) {
  Pose T_tilt_camera = Pose::Identity();
  T_tilt_camera.translate(Eigen::Vector3d(0.03, kStereoBaseline / 2, 0));
  // Columns: the camera's right, down and forward in the body's frame.
  T_tilt_camera.linear() << 0, 0, 1, -1, 0, 0, 0, -1, 0;
  Pose T_foot_tilt = Pose::Identity();
  T_foot_tilt.rotate(Eigen::AngleAxisd(shafts.pan, Eigen::Vector3d::UnitZ()));
  T_foot_tilt.translate(Eigen::Vector3d(0, 0, 0.08));
  T_foot_tilt.rotate(Eigen::AngleAxisd(shafts.tilt, Eigen::Vector3d::UnitY()));
  return T_world_head_foot() * T_foot_tilt * T_tilt_camera;
}

Pose T_head_left_right() {
  Pose pose = Pose::Identity();
  pose.translate(Eigen::Vector3d(kStereoBaseline, 0, 0));
  return pose;
}

}  // namespace foresight::sim

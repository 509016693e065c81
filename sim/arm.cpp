#include "sim/arm.hpp"

#include <numbers>
#include <sstream>

namespace foresight::sim {

const std::array<ArmJoint, kArmLinks - 1>& arm_joints() {
  static const Eigen::Vector3d y = Eigen::Vector3d::UnitY(), z = Eigen::Vector3d::UnitZ();
  static const std::array<ArmJoint, kArmLinks - 1> joints = {{
      {"shoulder_yaw", "arm_1", 0, false, {0, 0, 0.95}, z, -2.7, 2.7},
      {"shoulder_pitch", "arm_2", 1, false, {0, 0, 0.14}, y, -1.9, 1.9},
      {"upper_arm_roll", "arm_3", 2, false, {0, 0, 0.18}, z, -2.8, 2.8},
      {"elbow", "arm_4", 3, false, {0, 0, 0.18}, y, -2.35, 2.35},
      {"forearm_roll", "arm_5", 4, false, {0, 0, 0.17}, z, -2.8, 2.8},
      {"wrist_pitch", "arm_6", 5, false, {0, 0, 0.17}, y, -2.0, 2.0},
      {"wrist_roll", "arm_7", 6, false, {0, 0, 0.05}, z, -2.9, 2.9},
      {"finger", "finger_left", 7, true, {0, 0, 0.055}, y, 0, 0.04},
      {"finger_mimic", "finger_right", 7, true, {0, 0, 0.055}, -y, 0, 0.04, true},
  }};
  return joints;
}

Pose T_world_stand() {
  Pose pose = Pose::Identity();
  pose.translate(Eigen::Vector3d(-0.02, -0.60, -0.75));
  pose.rotate(Eigen::AngleAxisd(std::numbers::pi / 2, Eigen::Vector3d::UnitZ()));
  return pose;
}

std::array<Pose, kArmLinks> arm_links_at(const ArmPosition& position) {
  std::array<Pose, kArmLinks> out;
  out[0] = T_world_stand();
  for (std::size_t i = 0; i < arm_joints().size(); ++i) {
    const ArmJoint& joint = arm_joints()[i];
    Pose T = Pose::Identity();
    T.translate(joint.xyz);
    if (joint.slides)
      T.translate(position.opening * joint.axis);
    else
      T.rotate(Eigen::AngleAxisd(position.joints[i], joint.axis));
    out[i + 1] = out[static_cast<std::size_t>(joint.parent)] * T;
  }
  return out;
}

Pose pointing_down(const Eigen::Vector3d& p_world, double yaw) {
  Pose T = Pose::Identity();
  T.translate(p_world + Eigen::Vector3d(0, 0, kTips));
  T.rotate(Eigen::AngleAxisd(yaw, Eigen::Vector3d::UnitZ()) *
           Eigen::AngleAxisd(std::numbers::pi, Eigen::Vector3d::UnitX()));
  return T;
}

bool is_lab_arm(const UrdfRobot& robot, const Pose& T_world_root) {
  constexpr double kAlike = 1e-3;
  if (robot.links.size() != std::size_t{kArmLinks} || robot.links[0].name != kArmStand) return false;
  if (!T_world_root.isApprox(T_world_stand(), kAlike)) return false;
  for (std::size_t i = 0; i < arm_joints().size(); ++i) {
    const ArmJoint& own = arm_joints()[i];
    const UrdfJoint& other = robot.joints[i];
    const auto child = static_cast<std::size_t>(other.child);
    if (other.name != own.name || robot.links[child].name != own.child || robot.links[child].parent != own.parent)
      return false;
    if ((other.T_parent_joint.translation() - own.xyz).norm() > kAlike || !other.axis.isApprox(own.axis, kAlike) ||
        !other.T_parent_joint.linear().isIdentity(kAlike))
      return false;
  }
  return true;
}

std::string arm_urdf() {
  std::ostringstream text;
  text << "<?xml version=\"1.0\"?>\n<robot name=\"arm\">\n";
  const auto link = [&](const std::string& name) {
    text << "  <link name=\"" << name << "\"><visual><geometry><mesh filename=\"meshes/" << name
         << ".ply\"/></geometry></visual></link>\n";
  };
  link(kArmStand);
  for (const ArmJoint& joint : arm_joints()) {
    link(joint.child);
    const char* parent = joint.parent ? arm_joints()[static_cast<std::size_t>(joint.parent) - 1].child : kArmStand;
    text << "  <joint name=\"" << joint.name << "\" type=\"" << (joint.slides ? "prismatic" : "revolute")
         << "\">\n    <parent link=\"" << parent << "\"/><child link=\"" << joint.child << "\"/>\n    <origin xyz=\""
         << joint.xyz.transpose() << "\"/><axis xyz=\"" << joint.axis.transpose() << "\"/>\n    <limit lower=\""
         << joint.lower << "\" upper=\"" << joint.upper << "\" effort=\"100\" velocity=\"2\"/>\n";
    if (joint.mimics) text << "    <mimic joint=\"" << (&joint - 1)->name << "\"/>\n";
    text << "  </joint>\n";
  }
  text << "</robot>\n";
  return text.str();
}

}  // namespace foresight::sim

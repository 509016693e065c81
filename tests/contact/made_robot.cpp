#include "tests/contact/made_robot.hpp"

#include "sim/arm.hpp"
#include "sim/lab.hpp"
#include "tests/support/folders.hpp"

namespace foresight {

UrdfRobot made_gantry(const Mesh& tool) {
  UrdfRobot robot;
  robot.name = "gantry";
  robot.links.push_back({"base", {}, -1, Pose::Identity()});
  const char* names[] = {"x", "y", "z"};
  for (int i = 0; i < 3; ++i) {
    UrdfJoint joint;
    joint.name = names[i];
    joint.kind = UrdfJoint::Kind::sliding;
    joint.child = i + 1;
    joint.axis = Eigen::Vector3d::Unit(i);
    joint.lower = -1;
    joint.upper = 1;
    joint.velocity = 1;
    robot.joints.push_back(joint);
    robot.links.push_back({i == 2 ? "tool" : std::string("slide_") + names[i], {}, i, Pose::Identity()});
  }
  robot.links.back().mesh = tool;
  return robot;
}

std::vector<std::string> gantry_joints() {
  return {"x", "y", "z"};
}

UrdfRobot made_lab_arm(double velocity) {
  UrdfRobot robot = read_urdf(source_folder() / "configs/arm.urdf", MeshSearch{}, UrdfShapes::all);
  for (UrdfJoint& joint : robot.joints) joint.velocity = velocity;
  return robot;
}

std::vector<std::string> lab_arm_joints() {
  return {"shoulder_yaw", "shoulder_pitch", "upper_arm_roll", "elbow",
          "forearm_roll", "wrist_pitch",    "wrist_roll",     "finger"};
}

SceneModel made_scene(const std::vector<MadePart>& parts) {
  std::vector<Node> nodes;
  for (const MadePart& part : parts) nodes.push_back({part.name, part.mesh, -1, part.T_world});
  return SceneModel(std::move(nodes));
}

SceneModel lab_without_arm() {
  const sim::Lab lab = sim::make_lab(0.02, 1, true);
  std::vector<MadePart> parts;
  for (std::size_t i = 0; i < lab.parts.size(); ++i) {
    const auto arm = static_cast<std::size_t>(lab.arm);
    if (i >= arm && i < arm + sim::kArmLinks) continue;
    parts.push_back({lab.parts[i].name, sim::mesh_of(lab.parts[i]), lab.parts[i].T_world_part});
  }
  return made_scene(parts);
}

Pose shifted(double x, double y, double z) {
  Pose T = Pose::Identity();
  T.translation() = Eigen::Vector3d(x, y, z);
  return T;
}

Mesh made_sheet(float side) {
  const float h = side / 2;
  return {{{0, -h, -h}, {0, h, -h}, {0, h, h}, {0, -h, h}}, {{0, 1, 2}, {0, 2, 3}}, 0};
}

}  // namespace foresight

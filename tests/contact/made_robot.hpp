// Robots and scenes whose distances are known without measuring them.
#pragma once

#include <string>
#include <vector>

#include "scene/scene_model.hpp"
#include "scene/urdf_reader.hpp"

namespace foresight {

/// Three sliding joints "x", "y", "z" (-1 m to 1 m, 1 m/s), base to "tool", which is `tool`.
UrdfRobot made_gantry(const Mesh& tool);
std::vector<std::string> gantry_joints();

/// The lab's arm as configs/arm.urdf has it, with joints of that velocity, rad/s or m/s, and the names of those.
UrdfRobot made_lab_arm(double velocity = 2);
std::vector<std::string> lab_arm_joints();

struct MadePart {
  std::string name;
  Mesh mesh;
  Pose T_world = Pose::Identity();
};
SceneModel made_scene(const std::vector<MadePart>& parts);
/// The lab's furniture and things, without its arm.
SceneModel lab_without_arm();

Pose shifted(double x, double y, double z);
/// A square sheet without thickness, `side` metres, in the y z plane.
Mesh made_sheet(float side);

}  // namespace foresight

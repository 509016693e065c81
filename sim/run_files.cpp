#include "sim/run_files.hpp"

#include <fmt/core.h>

#include "scene/files.hpp"
#include "scene/number_text.hpp"
#include "scene/scene_writer.hpp"

namespace foresight::sim {
namespace fs = std::filesystem;

void write_scene(const fs::path& folder, const Lab& lab, const ArmPosition& arm) {
  fs::create_directory(folder / "meshes");
  std::string text = "accuracy_m: " + number_text(kLabAccuracy, 9) +
                     "  # the model is exact; this tells thin parts from what they lie on\nnodes:\n";
  for (int k = 0; k < static_cast<int>(lab.parts.size()); ++k) {
    const Part& part = lab.parts[static_cast<std::size_t>(k)];
    write_ply(folder / "meshes" / (part.name + ".ply"), mesh_of(part));
    if (k >= lab.arm && k < lab.arm + kArmLinks) continue;  // in the robot
    text += "  - name: " + part.name + "\n    mesh: meshes/" + part.name + ".ply\n";
    text += "    pose: " + pose_yaml(part.T_world_part) + "\n";
  }
  text += "robots:\n  - urdf: arm.urdf\n    pose: " + pose_yaml(T_world_stand()) + "\n    joints: {";
  for (std::size_t j = 0; j < arm.joints.size(); ++j)
    text += fmt::format("{}: {:.12g}, ", arm_joints()[j].name, arm.joints[j]);
  text += fmt::format("{}: {:.12g}}}\n", arm_joints()[arm.joints.size()].name, arm.opening);
  write_text(folder / "arm.urdf", arm_urdf());
  write_text(folder / "scene.yaml", text);
}

}  // namespace foresight::sim

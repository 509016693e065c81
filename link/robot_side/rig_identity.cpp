#include "link/robot_side/rig_identity.hpp"

#include <fmt/core.h>

#include <cmath>

#include "common/read_file.hpp"
#include "scene/yaml_fields.hpp"

namespace foresight::link {
namespace {

/// Of one key's file, relative to the rig; "" where the key is absent.
std::string file_text(const YamlMap& map, const std::string& key) {
  return map.has(key) ? read_file(map.file().parent_path() / map.text(key)) : "";
}

std::string calibration_text(const YamlMap& rig) {
  std::string out;
  if (rig.has("calibration")) {
    const YamlMap calibration = rig.map("calibration");
    for (const char* key : {"pan_tilt", "time", "tags", "photometric"}) out += file_text(calibration, key);
  }
  if (rig.has("cameras"))
    for (const char* side : {"left", "right"}) out += file_text(rig.map("cameras").map(side), "lens");
  return out;
}

// What is designed in round numbers is in the middle of a step, where rounding errors change nothing.
int in_steps(double metres) {
  constexpr double kStep = 1e-3, kAside = 0.3;
  return static_cast<int>(std::floor(metres / kStep + kAside));
}

}  // namespace

Identity rig_identity(const Rig& rig, const std::filesystem::path& file, const std::string& program) {
  const YamlMap map = YamlMap::load(file);
  Identity out;
  out.program = program;
  out.name = rig.name;
  out.rig = digest_of(map.text_without("link"));
  if (map.has("robot")) out.urdf = digest_of(file_text(map.map("robot"), "urdf"));
  if (const std::string text = calibration_text(map); !text.empty()) out.calibration = digest_of(text);
  out.joints = rig.joint_names();
  return out;
}

std::uint64_t scene_digest(const LiveScene& scene) {
  if (!scene.model()) return 0;
  const auto nowhere = [](std::string_view) { return std::optional(0.0); };
  const SceneState rest = scene.state_at({}, nowhere, StateStatus::exact);
  std::string text;
  for (std::size_t i = 0; i < scene.model()->nodes().size(); ++i) {
    const Node& node = scene.model()->nodes()[i];
    text += fmt::format("{} {} {}", node.name, node.mesh.vertices.size(), node.mesh.triangles.size());
    Eigen::AlignedBox3d box;
    for (const Eigen::Vector3f& vertex : node.mesh.vertices) box.extend(rest.T_world_node[i] * vertex.cast<double>());
    if (!box.isEmpty())
      for (const double metres :
           {box.min().x(), box.min().y(), box.min().z(), box.max().x(), box.max().y(), box.max().z()})
        text += fmt::format(" {}", in_steps(metres));
    text += "\n";
  }
  return digest_of(text);
}

}  // namespace foresight::link

#include "link/robot_side/rig_identity.hpp"

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

}  // namespace foresight::link

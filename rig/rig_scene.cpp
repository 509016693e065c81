#include "rig/rig_scene.hpp"

#include "scene/scene_reader.hpp"
#include "sim/arm.hpp"

namespace foresight {
namespace fs = std::filesystem;

std::shared_ptr<const RobotScene> rig_scene(const Rig* rig, const std::optional<fs::path>& scene_file) {
  const auto& named = scene_file || !rig ? scene_file : rig->scene;
  std::optional<SceneModel> scene;
  if (named) {
    const fs::path file = fs::absolute(*named);
    scene = read_scene(file, file.parent_path());
  }
  return std::make_shared<const RobotScene>(scene ? &*scene : nullptr, rig ? rig->robot : std::nullopt,
                                            rig ? rig->T_world_robot : Pose::Identity());
}

MockWorld mock_world(const Rig& rig, const std::optional<fs::path>& scene_file) {
  MockWorld out = mock_world(rig.calibration ? rig.calibration->tags : std::nullopt);
  out.furniture = !scene_file && !rig.scene;
  const bool own_robot = rig.robot && !sim::is_lab_arm(*rig.robot, rig.T_world_robot);
  if (!out.furniture || own_robot) out.things = rig_scene(&rig, scene_file);
  if (out.things && !out.things->model()) out.things = nullptr;
  return out;
}

std::string_view shaft_name(const Rig& rig, std::string_view joint) {
  if (joint != "pan" && joint != "tilt") return joint;
  std::vector<std::string_view> head;
  for (const RigJoint& other : rig.joints) {
    if (other.drive.name == joint) return joint;
    if (other.group == JointGroup::pan_tilt) head.push_back(other.drive.name);
  }
  const std::size_t at = joint == "pan" ? 0 : 1;
  return at < head.size() ? head[at] : joint;
}

}  // namespace foresight

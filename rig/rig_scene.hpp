// What stands around a rig's cameras: the scene that its file names, and its robot.
#pragma once

#include <filesystem>
#include <memory>
#include <optional>

#include "rig/open_stereo.hpp"
#include "rig/rig.hpp"
#include "scene/robot_scene.hpp"

namespace foresight {

/// The scene of `scene_file` or, without one, that of the rig (scene/scene_reader.hpp), and the rig's robot in it.
/// `rig` may be null. Throws what read_scene() and RobotScene do.
std::shared_ptr<const RobotScene> rig_scene(const Rig* rig, const std::optional<std::filesystem::path>& scene_file);

/// What mock cameras of this rig see: its tags, and where it or `scene_file` names a scene, that one with the robot, in
/// place of the lab. Without one, the lab with the rig's robot in it: the lab's own arm where the rig has none or that
/// very one. Throws what mock_world() and rig_scene() do.
MockWorld mock_world(const Rig& rig, const std::optional<std::filesystem::path>& scene_file = {});

/// The mock lab's shafts by the names of the lab: its head's "pan" and "tilt" are the first two joints of the rig's
/// group pan_tilt, whatever they are called.
std::string_view shaft_name(const Rig& rig, std::string_view joint);

}  // namespace foresight

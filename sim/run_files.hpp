// The text files of a run, as scene/run_folder.hpp reads them.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "common/lens.hpp"
#include "sim/arm.hpp"
#include "sim/lab.hpp"

namespace foresight::sim {

/// Both throw RuntimeFailure where the file cannot be written whole.
void write_bytes(const std::filesystem::path& file, const void* data, std::size_t size);
void write_text(const std::filesystem::path& file, const std::string& text);

/// "tx ty tz qx qy qz qw".
std::string pose_text(const Pose& pose);

/// camera.yaml; with `T_left_right` the right camera's.
std::string camera_yaml(const Lens& lens, const std::string& name, const Pose* T_left_right);

/// Writes scene.yaml and meshes/ of any model; its robots become plain nodes.
void write_model(const std::filesystem::path& folder, const SceneModel& scene);

/// Writes scene.yaml, arm.urdf and meshes/ into `folder`; the robot's `joints` are those of `arm`.
void write_scene(const std::filesystem::path& folder, const Lab& lab, const ArmPosition& arm);

}  // namespace foresight::sim

// The lab's scene as the files that scene/scene_reader.hpp reads.
#pragma once

#include <filesystem>
#include <string>

#include "sim/arm.hpp"
#include "sim/lab.hpp"

namespace foresight::sim {

/// Writes scene.yaml, arm.urdf and meshes/ into `folder`; the robot's `joints` are those of `arm`.
void write_scene(const std::filesystem::path& folder, const Lab& lab, const ArmPosition& arm);

}  // namespace foresight::sim

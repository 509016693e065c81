// Writes scenes as scene/scene_reader.hpp reads them.
#pragma once

#include <filesystem>
#include <string>

#include "scene/scene_model.hpp"

namespace foresight {

/// Writes scene.yaml and meshes/ of any model into the folder; robots that it was read from are plain nodes. Throws
/// RuntimeFailure where they cannot be written whole.
void write_model(const std::filesystem::path& folder, const SceneModel& scene);

/// A mesh file (PLY). Throws RuntimeFailure.
void write_ply(const std::filesystem::path& file, const Mesh& mesh);

/// "{xyz: [x, y, z], quaternion: [x, y, z, w]}".
std::string pose_yaml(const Pose& pose);

}  // namespace foresight

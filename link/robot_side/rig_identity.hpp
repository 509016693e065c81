// How a rig introduces itself to the other side of a line.
#pragma once

#include <filesystem>

#include "link/control/identity.hpp"
#include "rig/rig.hpp"
#include "session/live_scene.hpp"

namespace foresight::link {

/// With digests of what the rig file says, but for its `link:` section, which each host has its own of; and of its URDF
/// and all calibrations that it names (lenses included), by their bytes.
/// `rig`: as read from `file`. Throws InputError where a file cannot be read any more.
Identity rig_identity(const Rig& rig, const std::filesystem::path& file, const std::string& program);

/// Of the model's nodes: names, shapes, and where they stand at rest, in steps of 1 mm, so that it says the same on
/// another machine; for Identity::scene. 0 without a model.
std::uint64_t scene_digest(const LiveScene& scene);

}  // namespace foresight::link

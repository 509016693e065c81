// How a rig introduces itself to the other side of a line.
#pragma once

#include <filesystem>

#include "link/control/identity.hpp"
#include "rig/rig.hpp"

namespace foresight::link {

/// With digests of what the rig file says, but for its `link:` section, which each host has its own of; and of its URDF
/// and all calibrations that it names (lenses included), by their bytes.
/// `rig`: as read from `file`. Throws InputError where a file cannot be read any more.
Identity rig_identity(const Rig& rig, const std::filesystem::path& file, const std::string& program);

}  // namespace foresight::link

// Is a run in metres? Meshes come in millimetres, too, and nothing in them says so.
#pragma once

#include <optional>
#include <string>

#include "scene/run_folder.hpp"

namespace foresight {

/// What looks as if it were in another unit, and what to do, in words; nothing where all looks right. A part of the
/// model that is 250 m large or more and 250 times as large as all of the camera's path; or a model of which no image
/// shows more than some pixels.
std::optional<std::string> doubt_of_units(const RunFolder& run);

}  // namespace foresight

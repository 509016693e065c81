// The lens of a head display's panel, as `foresight calibrate display` found it.
#pragma once

#include <filesystem>

#include "common/lens.hpp"

namespace foresight {

/// A lens whose image is the panel: a picture drawn through it is seen straight through the display's optics. That of
/// green where colours have lenses of their own. Throws what read_result()
/// does, of another kind of result for one.
Lens read_panel_lens(const std::filesystem::path& file);

}  // namespace foresight

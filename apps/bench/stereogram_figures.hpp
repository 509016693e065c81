// What stereograms of a run's scene cost, by size and way of making strips, and what can be read from them.
#pragma once

#include <nlohmann/json_fwd.hpp>

#include "scene/run_folder.hpp"

namespace foresight {

/// Of pictures of `width` px, and of twice as many. Prints a table; one object a row. Needs a current context. Wall
/// time is of the GPU's work alone, waited for.
nlohmann::json stereogram_figures(const RunFolder& run, int width);

}  // namespace foresight

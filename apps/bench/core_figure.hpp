// What arrives after half a second, what the thesis' pipeline makes of it, and what the core makes of it.
#pragma once

#include "apps/bench/figure_page.hpp"
#include "apps/run_options.hpp"

namespace foresight {

/// Makes an OpenGL context for each pipeline. Throws InputError: `run` is shorter than the delay.
FigurePage core_figure(const RunFolder& run, const TextureOptions& core);

}  // namespace foresight

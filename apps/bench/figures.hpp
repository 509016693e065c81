// `foresight bench figures`: the effect of each step of the thesis' pipeline, as pictures.
#pragma once

#include "apps/run_options.hpp"

namespace foresight {

struct FigureOptions : RunOptions {
  std::filesystem::path out;  ///< folder, made where it is missing
};

std::vector<Output> figure_outputs(const std::filesystem::path& out);

/// Returns the exit code. Throws InputError and RuntimeFailure.
int draw_figures(const FigureOptions& options);

}  // namespace foresight

// `foresight bench figures`: the effect of each step of the thesis' pipeline, as pictures.
#pragma once

#include <filesystem>

namespace foresight {

struct FigureOptions {
  std::filesystem::path run;
  std::filesystem::path out;  ///< folder, made where it is missing
};

/// Returns the exit code. Throws InputError and RuntimeFailure.
int draw_figures(const FigureOptions& options);

}  // namespace foresight

// `foresight bench margin`: how many texels a registration error paints wrong, counted with truth.
#pragma once

#include <filesystem>
#include <optional>

namespace foresight {

struct MarginBenchOptions {
  std::filesystem::path run;  ///< with truth, and without errors of its own
  std::optional<std::filesystem::path> json;
  std::optional<std::filesystem::path> plot;  ///< SVG
  int images = 10;                            ///< of the run, evenly spread
};

/// For pose errors of 0 to 3 px, each image's of its own: texels that the core and the thesis' pipeline
/// paint wrong, with and without what they do against it, and what that costs in right ones.
/// Returns the exit code. Throws InputError and RuntimeFailure.
int bench_margin(const MarginBenchOptions& options);

}  // namespace foresight

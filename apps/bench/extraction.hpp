// `foresight bench extraction`: the core beside the pipeline of the thesis, on the same images.
#pragma once

#include <filesystem>
#include <optional>

namespace foresight {

struct ExtractionBenchOptions {
  std::filesystem::path run;
  std::optional<std::filesystem::path> json;
  std::optional<int> images;  ///< the first so many; default: all
  bool tables = true;         ///< tables 7.1 to 7.4 of the thesis, not only the comparison
};

/// Prints tables of CPU time; the numbers also go to `json`. Returns the exit code. Throws
/// InputError and RuntimeFailure.
int bench_extraction(const ExtractionBenchOptions& options);

}  // namespace foresight

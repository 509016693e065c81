// `foresight bench calibration`: our solver beside OpenCV's own calls, on the same corners in the same run.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

namespace foresight {

struct CalibrationBenchOptions {
  std::filesystem::path corners;  ///< of a pair
  std::string board;
  std::string size = "640x480";
  std::optional<std::filesystem::path> images;  ///< of the board: corner detection is measured too
  int runs = 5;
  std::optional<std::filesystem::path> json;
};

/// CPU time of one stereo solution (median over runs, both taken in turn), and the error on each view
/// left out when solved from the others; the same for 50 pairs simulated from the solution, with the
/// error against it; and of finding the corners in images, refinement included. Returns 1 where ours predicts worse
/// than OpenCV's.
int bench_calibration(const CalibrationBenchOptions& options);

}  // namespace foresight

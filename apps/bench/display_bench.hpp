// `foresight bench display`: how punctual the display is beside the extraction, and what stays for that.
#pragma once

#include <filesystem>
#include <opencv2/core.hpp>
#include <optional>
#include <string>

namespace foresight {

struct DisplayBenchOptions {
  std::string size = "800x600";  ///< of the view
  double seconds = 5;            ///< of each round
  double long_seconds = 0;       ///< of that beside the extraction at 25 Hz; 0: as the others
  double rate_hz = 0;            ///< this one alone; 0: those of table 7.5
  std::optional<std::filesystem::path> json;
};

/// The lab, seen from where most and from where fewest of its polygons are, at the rates of the thesis' table 7.5:
/// frames alone, with the extraction beside them, and the same without pacing; at 25 Hz also as the seat fills a window
/// of that size, alone and beside the extraction. Returns 1 where a bar of docs/performance.md is missed. Throws
/// RuntimeFailure (no OpenGL), InputError (a size).
int bench_display(const DisplayBenchOptions& options);

}  // namespace foresight

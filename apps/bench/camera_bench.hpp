// `foresight bench camera`: what the mock cameras cost, rendering and all else apart.
#pragma once

#include <filesystem>
#include <optional>

namespace foresight {

struct CameraBenchOptions {
  int width = 640, height = 480;  ///< px
  double rate = 30;               ///< pairs per second
  double seconds = 5;             ///< of each of two rounds
  std::optional<std::filesystem::path> json;
};

/// Stereo pairs of the mock lab, once as quick as they come and once at `rate`. Returns 1 where all that is not
/// rendering (copying, waiting, conversion, pairing, handing over) takes a tenth of a core or more, or no pair came.
int bench_camera(const CameraBenchOptions& options);

}  // namespace foresight

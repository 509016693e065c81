// `foresight bench view`: what drawing the predicted view costs.
#pragma once

#include <filesystem>
#include <optional>

namespace foresight {

struct ViewBenchOptions {
  std::filesystem::path run;
  std::optional<std::filesystem::path> json;
  int images = 20;  ///< of the run's first: all become textures, the later half is drawn
  int ahead = 1;    ///< a view is drawn where the camera is so many images after the newest
  int rounds = 5;   ///< drawings of each, of which the median counts
};

/// CPU time of the process for one view at the pose of an image that is still to come, drawn by a single
/// program for all cases, by the two of PredictedView, and from the newest image first, in turn; and how alike their
/// pictures and that image are. Returns the exit code. Throws InputError and RuntimeFailure.
int bench_view(const ViewBenchOptions& options);

}  // namespace foresight

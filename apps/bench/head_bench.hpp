// `foresight bench head`: what warping a drawn view to where the head is by now costs, and how it looks.
#pragma once

#include <filesystem>
#include <optional>

namespace foresight {

struct HeadBenchOptions {
  std::filesystem::path run;      ///< whose images give the textures
  int width = 640, height = 480;  ///< px of a view
  int views = 40;
  double degrees = 2, metres = 0.02;  ///< of head motion between drawing and showing
  double eyes_apart = 0.065;          ///< m
  unsigned seed = 1;
  std::optional<std::filesystem::path> json;
};

/// Textures of the run's first images, then `views` random motions of the head: each drawn anew, and warped from the
/// view before it. Prints decibels over all pixels, holes before filling, CPU time of both; likewise of a second eye
/// warped from the first; then what stereograms of the scene cost. Returns 0.
int bench_head(const HeadBenchOptions& options);

}  // namespace foresight

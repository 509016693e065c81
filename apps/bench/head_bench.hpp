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
  std::optional<std::filesystem::path> path;  ///< a recorded head; nothing: that is left out
  double seconds = 12;                        ///< of each trial in real time; 0: none
  double rate_hz = 20;                        ///< of them; pictures of half the size come 2.25 times as often
  std::size_t building = 200'000;             ///< triangles of the building that portals are measured in
  std::optional<std::filesystem::path> json;
};

/// Textures of the run's first images, then `views` random motions of the head: each drawn anew, and warped from the
/// view before it. Prints decibels over all pixels, holes before filling, CPU time of both; likewise of a second eye
/// made of the first; then how far off views of a recorded head are, how long frames of a head display take in real
/// time, what portals leave out of a building, what a sorting buffer
/// saves, and what stereograms of the scene cost. Returns 0.
int bench_head(const HeadBenchOptions& options);

}  // namespace foresight

// How time-critical drawing keeps a budget, and what that costs in the picture.
#pragma once

#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <optional>

#include "scene/pose_track.hpp"

namespace foresight {

struct LevelTrial {
  std::size_t triangles = 200'000;  ///< of the building, and of the workshop
  int width = 640, height = 480;    ///< px of a view
  int frames = 150;                 ///< at most
  unsigned seed = 1;
  /// Of the workshop: in full, within 120 ms, and which levels, side by side.
  std::optional<std::filesystem::path> picture;
};

/// In a building and in a workshop (sim/), frames of a head (axes x right, y up, as recorded) at 10 Hz: CPU-ms and
/// decibels against full detail, of budgets of 30, 60, 120 and 240 ms with predictive and reactive selection; how often
/// levels oscillate with and without hysteresis; static and psychophysical selection; the largest jump that a change of
/// level makes by kind of transition; and how often things that move are moved. Prints them; keys: building, workshop.
/// In the current context.
nlohmann::json level_figures(const LevelTrial& trial, const PoseTrack& head);

}  // namespace foresight

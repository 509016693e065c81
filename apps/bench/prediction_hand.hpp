// `foresight bench prediction hand`: what filtering takes from the noise of tracked hands, and what it costs in time.
#pragma once

#include <filesystem>
#include <optional>

namespace foresight {

struct PredictionHandOptions {
  std::filesystem::path csv;
  std::optional<std::filesystem::path> json;
};

/// Filters every pose of the recording but the head's, as it comes, and compares with the parabola through the 60 ms to
/// both sides of each instant. Prints, and writes to `json`, all poses pooled, and for each in `poses`:
///   noise_mm, noise_deg     rms distance from that parabola
///   jitter_mm, jitter_deg   rms second difference from row to row
///   lag_ms                  by which delay of the parabola the distance is least
///   raw_*                   the same of the recording itself
///   low_pass_*              of a low-pass filter of 30 ms
///   scored                  instants
/// Returns 0. Throws InputError as read_pose_table, and where nothing can be judged.
int bench_prediction_hand(const PredictionHandOptions& options);

}  // namespace foresight

// `foresight bench prediction head`: where a head will be when its picture is seen, beside simple guesses.
#pragma once

#include <filesystem>
#include <optional>

namespace foresight {

struct PredictionHeadOptions {
  std::filesystem::path csv;
  double ahead_ms = 100;
  std::optional<std::filesystem::path> json;
};

/// Goes through the recording as the tracker did: at each row, the pose `ahead_ms` later is predicted from that row and
/// those before, and judged by the recording, interpolated between its rows. Prints, and writes to `json`:
///   p95_mm, p95_deg             95 % of the predictions are nearer than that; rms_mm, rms_deg likewise
///   constant_velocity_50ms_*    the mean velocity of the last 50 ms goes on
///   newest_two_*                the velocity between the newest two rows goes on
///   hold_*                      the newest pose stays
///   inside_2_sigma, rotation_inside_2_sigma   share of the truths within twice the uncertainty that was told
///   scored, rows, lost, anew, repeated        instants judged (the same ones for all), and what the recording holds
///   mean_us                     thread CPU time per row
/// Returns 0. Throws InputError as read_pose_table, and where fewer than 30 instants can be judged.
int bench_prediction_head(const PredictionHeadOptions& options);

}  // namespace foresight

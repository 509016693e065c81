// `foresight bench prediction response`: where commanded joints will be, by what was learnt of their drives.
#pragma once

#include <filesystem>
#include <optional>

namespace foresight {

struct PredictionResponseOptions {
  std::filesystem::path commands, states;
  std::optional<std::filesystem::path> json;
};

/// Learns each joint's response from the first 40 % of the time, and keeps it. Then, from each state and the commands
/// up to 100, 300 and 1,000 ms later, predicts the state at that time; judged by the states, interpolated. Joints and
/// instants pooled. Prints, and writes to `json`:
///   p95_rad_100ms, _300ms, _1000ms   95 % of the predictions are nearer (m for joints that slide); rms_rad_* likewise
///   hold_*       the state stays
///   velocity_*   the state goes on at its velocity (dq1, ... of the states; else over their last 20 ms)
///   increment_*  the state and how far the command goes on
///   online_*     learning goes on, once a second
///   inside_2_sigma_*   share of the truths within twice the uncertainty that was told
///   joints       of each: name, whether it was identified, delay_s, dead_time_s, lag_s, with delay_sigma_s and
///                dead_time_sigma_s; unexplained_rad; explained, the share of its motion that the commands explain
///                (little of it: another clock, another unit, which is also said); evened_s: by how much the stamps
///                of its commands scatter about an even interval, where that explains more than the stamps do; else 0
///   scored       predictions judged, per horizon
/// Returns 0. Throws InputError as read_joint_table, and where the files share no joint or no time, or nothing can be
/// judged.
int bench_prediction_response(const PredictionResponseOptions& options);

}  // namespace foresight

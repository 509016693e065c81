// `foresight bench prediction robot`: where a robot will be when set-points act that are on their way.
#pragma once

#include <filesystem>
#include <optional>

namespace foresight {

struct PredictionRobotOptions {
  std::filesystem::path rig;
  double delay_ms = 500;  ///< each way
  double jitter_ms = 0;   ///< more, evenly from 0 to this
  double loss = 0;        ///< share of set-points and reports
  double seconds = 60;
  unsigned seed = 1;
  std::optional<std::filesystem::path> json;
};

/// A rig with emulated drives in stepped time, moved at random up to full speed over a line (robot_trial.hpp). Shown is
/// the robot at the instant at which a set-point that is sent now acts; judged by what the encoders told of that
/// instant in free motion, which is all but where the gate held the robot back. Prints, and writes to `json`:
///   tool_p95_mm, tool_rms_mm, tool_worst_mm   distance of the tool from where it was shown; _deg: rotation p95
///   tool_inside_2_sigma, joints_inside_2_sigma   share of the truths within twice the uncertainty that was told
///   joint_p95_rad, pixel_p95_px    likewise; the camera stands 1.5 m away and has a focal length of 525 px
///   shaft_tool_p95_mm              by the emulated shafts themselves
///   hold_, velocity_, asked_tool_p95_mm   the last state stays; goes on as fast as it was; the joints that are asked
///   for held_tool_p95_mm, held         while the gate held the robot back; how many pictures that were pictures,
///   judged, invalid, invalid_words   shown, judged in free motion; share that was said to be unknown, and why
///   largest_step_over_limit        of a joint from picture to picture, over its velocity times that time
///   drives    of each joint that was learnt: joint, dead_time_s, lag_s, sigma_s (of their sum), explained
///   delay_ms_told, cpu_share, moved_rad, fastest_share
/// Returns 1 where nothing could be judged, else 0. Throws InputError as read_rig and try_robot.
int bench_prediction_robot(const PredictionRobotOptions& options);

}  // namespace foresight

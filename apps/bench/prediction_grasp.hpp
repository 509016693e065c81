// `foresight bench prediction grasp`: things that a hand takes along, predicted over a delayed line.
#pragma once

#include <filesystem>
#include <optional>

namespace foresight {

struct PredictionGraspOptions {
  std::filesystem::path rig = "configs/minerva.yaml";  ///< whose robot is the mock lab's arm
  int first_run = 1;                                   ///< >= 1: each run draws from its own number and the seed
  int runs = 20;
  double failing = 0.2;   ///< share of runs in which something is wrong
  double delay_ms = 500;  ///< each way
  unsigned seed = 1;
  std::optional<std::filesystem::path> json;
};

/// Each run, in stepped time (grasp_trial.hpp): a brick stands somewhere on the mat of the physical lab; a script
/// grasps, carries and sets it down through the gate and the emulated drives. Prints, and writes to `json`:
///   object_p95_mm            distance of the shown brick from the true one of that instant: while it is carried, and
///                            at rest once it was seen again; object_carried_p95_mm, object_rest_p95_mm: either by
///                            itself
///   object_unseen_p95_mm     the same at rest, before cameras have told
///   failed_grasps, failed_grasps_noticed   runs in which the jaws did not bring it to where they set it down; those of
///                            them in which that was noticed within the delay and 0.3 s of its first being visible
///   failed_grasps_not_noticed, failed_grasps_never_off   of those that failed: never put elsewhere though it was
///                            elsewhere; shown where it was all the time, so that there was nothing to notice
///   noticed_slowest_ms       from visible to noticed, less the delay
///   false_alarms             times that a thing was put elsewhere in runs that did not fail, before it was visible
///                            that it was not where it was shown
///   runs_that_failed         and others in which it was put elsewhere: run, accident, failed, visible_ms since the
///                            script began, noticed_ms from then on less the delay, put_elsewhere (times),
///                            before_visible (of these)
///   first_run, runs, judged, sighting_sigma_mm, sighting_hz, delay_ms
/// Each run is drawn from its number and the seed; the arm comes to it from the run before, of which the first run's
/// is not judged: so it can be repeated alone but for how the arm and the drives' model got there.
/// Returns 1 where nothing could be judged, or a failed grasp was noticed too late or never; else 0. Throws InputError
/// as read_rig and try_robot, and where the rig's robot is not the lab's arm with a joint "finger".
int bench_prediction_grasp(const PredictionGraspOptions& options);

}  // namespace foresight

// `foresight bench prediction grasp`: things that a hand takes along, predicted over a delayed line.
#pragma once

#include <filesystem>
#include <optional>

namespace foresight {

struct PredictionGraspOptions {
  std::filesystem::path rig = "configs/minerva.yaml";  ///< whose robot is the mock lab's arm
  int runs = 20;
  double delay_ms = 500;  ///< each way
  unsigned seed = 1;
  std::optional<std::filesystem::path> json;
};

/// Each run, in stepped time (grasp_trial.hpp): a brick stands somewhere on the mat of the physical lab; a script
/// grasps, carries and sets it down through the gate and the emulated drives. Prints, and writes to `json`:
///   object_p95_mm            distance of the shown brick from the true one of that instant: while it is carried, and
///   at rest
///                            once it was seen again; object_carried_p95_mm, object_rest_p95_mm: either by itself
///   object_unseen_p95_mm     the same at rest, before cameras have told
///   failed_grasps, failed_grasps_noticed   runs in which the jaws did not bring it to where they set it down; those of
///   them in which that was noticed within the delay and 0.3 s of its first being visible
///   noticed_slowest_ms       from visible to noticed, less the delay
///   false_alarms             times that a thing was taken for lost though it was where it was shown to 10 mm
///   runs, judged, sighting_sigma_mm, sighting_hz, delay_ms
/// Returns 1 where nothing could be judged, or a failed grasp was noticed too late or never; else 0. Throws InputError
/// as read_rig and try_robot, and where the rig's robot is not the lab's arm with a joint "finger".
int bench_prediction_grasp(const PredictionGraspOptions& options);

}  // namespace foresight

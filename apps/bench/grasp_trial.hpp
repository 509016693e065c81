// Bricks that are grasped, carried and set down in the physical lab, and what an operator's side shows of them.
//
//   script --set-points--> line --> gate, emulated drives --shafts--> physical lab: where the brick truly is
//                                                                        | sightings: noise, the line's delay
//   RobotFuture --predicted joints--> ThingFuture: what is shown <-------'       compared once the instant has come
#pragma once

#include <vector>

#include "rig/rig.hpp"

namespace foresight {

struct GraspTrialOptions {
  int runs = 20;
  double delay = 0.5;  ///< s, each way
  unsigned seed = 1;
  double failing = 0.2;  ///< share of runs in which something is wrong with the brick or the jaws
  /// One sigma of a sighting, along each axis, and about each. AprilTag's corners are good to 0.14 px
  /// (docs/calibration.md, "by the tags"): a tag of 36 mm, 0.7 m before stereo cameras of 640x480 px (focal length 525
  /// px, 65 mm apart), is then known to 1 mm along the line of sight and 0.1 mm across, and turned to 1 degree.
  double sighting_sigma = 0.0015, sighting_sigma_rad = 0.0175;
};

struct GraspTrialFigures {
  std::vector<double> carried, rest, unseen;  ///< m, of each picture
  int failed = 0, noticed = 0, false_alarms = 0, runs = 0;
  int never_off = 0;  ///< of those that failed: shown where it was all the time, so that nothing was there to notice
  std::vector<double> lateness;  ///< s, of failed grasps that were noticed: from visible to noticed, less the delay
  double sighting_hz = 0;
};

/// Throws as bench_prediction_grasp().
GraspTrialFigures try_grasps(const Rig& rig, const GraspTrialOptions& options);

}  // namespace foresight

// Bricks that are grasped, carried and set down in the physical lab, and what an operator's side shows of them.
//
//   script --set-points--> line --> gate, emulated drives --shafts--> physical lab: where the brick truly is
//                                                                        | sightings: noise, the line's delay
//   RobotFuture --predicted joints--> ThingFuture: what is shown <-------'       compared once the instant has come
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "rig/rig.hpp"

namespace foresight {

struct GraspTrialOptions {
  int first_run = 1;  ///< >= 1: another run comes before, in which the drives are learnt, and which is not judged
  int runs = 20;
  double delay = 0.5;    ///< s, each way
  unsigned seed = 1;     ///< with the run's number: of all that is drawn in it
  double failing = 0.2;  ///< share of runs in which something is wrong with the brick or the jaws
  /// One sigma of a sighting, along each axis, and about each. AprilTag's corners are good to 0.14 px
  /// (docs/calibration.md, "by the tags"): a tag of 36 mm, 0.7 m before stereo cameras of 640x480 px (focal length 525
  /// px, 65 mm apart), is then known to 1 mm along the line of sight and 0.1 mm across, and turned to 1 degree.
  double sighting_sigma = 0.0015, sighting_sigma_rad = 0.0175;
};

/// What became of one run.
struct GraspRun {
  int number = 0;
  std::string accident;  ///< what was wrong with it: none, slippery, weak, moved, lost
  bool failed = false;   ///< the jaws did not bring the brick to where they set it down
  /// s after the script began: when one first saw that the brick is not where it is shown; not in every run.
  std::optional<double> visible;
  std::optional<double> lateness;  ///< s, from then on until it was put elsewhere, less the delay; where it ever was
  int put_elsewhere = 0;           ///< times
  int before_visible = 0;          ///< of these, before it was visible: mistakes, where the run did not fail
};

struct GraspTrialFigures {
  std::vector<GraspRun> runs;
  std::vector<double> carried, rest, unseen;  ///< m, of each picture
  double sighting_hz = 0;
};

/// Throws as bench_prediction_grasp().
GraspTrialFigures try_grasps(const Rig& rig, const GraspTrialOptions& options);

}  // namespace foresight

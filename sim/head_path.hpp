// Where the head is: a recorded path instead of the built-in one.
#pragma once

#include <filesystem>

#include "scene/pose_track.hpp"
#include "sim/lab.hpp"

namespace foresight::sim {

/// Immutable; safe to share between threads.
class HeadPath {
 public:
  /// Reads a trajectory in the form of TUM RGB-D runs: time tx ty tz qx qy qz qw, T_world_camera of
  /// the left camera, seconds from the start of the run. Throws InputError naming file and line: not
  /// in this form, a gap above 0.2 s, a start after 0 s or an end before `last` seconds.
  HeadPath(const std::filesystem::path& file, double last);

  /// Interpolated; held at the ends.
  Pose at(double t) const;

 private:
  PoseTrack track_;
};

/// Tells whether a camera has left the lab or is in one of its solids.
class RoomCheck {
 public:
  explicit RoomCheck(const Lab& lab);

  /// What is wrong with a camera at `eye` (world), such as "is inside 'table'"; empty where nothing is.
  std::string fault(const Eigen::Vector3d& eye, const LabState& T_world_part) const;

 private:
  struct Solid;
  std::vector<std::shared_ptr<const Solid>> solids_;
};

}  // namespace foresight::sim

// Recorded poses of a head, hands or devices: a table of one row per frame of the tracker.
//
//   time_s,head_x,head_y,head_z,head_qx,head_qy,head_qz,head_qw,L_valid,L_grip_x, ...
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "scene/pose_track.hpp"

namespace foresight {

/// The poses whose columns share a prefix.
struct PoseSeries {
  std::string prefix;                      ///< "head_", or empty
  std::vector<std::optional<Pose>> poses;  ///< one per row; nothing where the tracker had lost it
};

struct PoseTable {
  std::vector<std::int64_t> time_ns;  ///< strictly ascending, since the first row
  std::vector<PoseSeries> series;     ///< at least one
  std::size_t repeated = 0;           ///< rows left out because they had the time of the one before
};

/// Reads a CSV whose first line names `time_s` (seconds) or `timestamp` (nanoseconds, or ticks of 100 ns since the year
/// 1 as Windows counts them), and for each pose x y z (m) and qx qy qz qw, perhaps after a prefix. A pose is lost where
/// a number of it is `nan` or the quaternion's length is not 1 within 1 %. Throws InputError naming file, line and
/// cure: no such columns, no row, a field that is no number, another number of fields, a time before that of the line
/// before.
PoseTable read_pose_table(const std::filesystem::path& csv);

/// The series of the head, else the first one.
const PoseSeries& head_of(const PoseTable& table);
/// Its poses over time, without those that were lost.
PoseTrack head_track(const PoseTable& table);

}  // namespace foresight

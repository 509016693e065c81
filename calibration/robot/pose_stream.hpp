// Poses over time from files, for clocks that are compared.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "scene/pose_track.hpp"

namespace foresight {

struct PoseStream {
  std::vector<PoseTrack::Sample> samples;  ///< strictly ascending in time
  std::vector<std::string> notes;          ///< repeated rows that were passed over
};

/// Of the times in a file. `automatic`: by the size of unix times, else by the usual step from row to row, for streams
/// of 0.5 to 200 rows a second; what is not seconds is noted.
enum class TimeUnit { automatic, second, millisecond, microsecond, nanosecond };

/// Rows t x y z qx qy qz qw, blanks or commas between; t exact to the nanosecond; a
/// first row of column names is passed over, and so are rows that repeat the time before them.
/// Throws InputError naming file and line: another number of fields, no number, no unit quaternion,
/// a time before the one above it (unsorted).
PoseStream read_pose_stream(const std::filesystem::path& file, TimeUnit unit = TimeUnit::automatic);

struct JointRow {
  RobotTime time;
  std::vector<double> positions;  ///< rad or m
};

struct JointStream {
  std::vector<JointRow> rows;  ///< strictly ascending in time
  std::vector<std::string> notes;
};

/// Rows t q1 q2 ...; every row as many joints as the first. Throws like read_pose_stream.
JointStream read_joint_stream(const std::filesystem::path& file, TimeUnit unit = TimeUnit::automatic);

/// Poses of a body that turns by the first joint about z, then by the second about y: what one or
/// two swept joints of a pan-tilt head do to a camera, up to fixed rotations. Throws InputError at
/// `where` for more joints.
std::vector<PoseTrack::Sample> swept_poses(const std::vector<JointRow>& rows, const std::string& where);

}  // namespace foresight

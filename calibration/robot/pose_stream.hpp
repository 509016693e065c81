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

/// Rows t x y z qx qy qz qw, blanks or commas between; t in seconds, exact to the nanosecond; a
/// first row of column names is passed over, and so are rows that repeat the time before them.
/// Throws InputError naming file and line: another number of fields, no number, no unit quaternion,
/// a time before the one above it (unsorted).
PoseStream read_pose_stream(const std::filesystem::path& file);

struct JointRow {
  RobotTime time;
  std::vector<double> positions;  ///< rad or m
};

/// Rows t q1 q2 ...; every row as many joints as the first. Throws like read_pose_stream.
std::vector<JointRow> read_joint_stream(const std::filesystem::path& file);

/// Poses of a body that turns by the first joint about z, then by the second about y: what one or
/// two swept joints of a pan-tilt head do to a camera, up to fixed rotations. Throws InputError at
/// `where` for more joints.
std::vector<PoseTrack::Sample> swept_poses(const std::vector<JointRow>& rows, const std::string& where);

}  // namespace foresight

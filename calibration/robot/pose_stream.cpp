#include "calibration/robot/pose_stream.hpp"

#include "calibration/robot/robot_poses.hpp"
#include "common/error.hpp"
#include "common/text.hpp"
#include "scene/text_table.hpp"

namespace foresight {
namespace {

bool is_header(const FieldRow& row) {
  return !parse_number(row.fields.front()) && !parse_number(row.fields.back());
}

std::vector<FieldRow> timed_rows(const std::filesystem::path& file, const std::string& form) {
  std::vector<FieldRow> rows = read_field_rows(file);
  if (!rows.empty() && is_header(rows.front())) rows.erase(rows.begin());
  if (rows.empty()) throw InputError(file.string(), "holds no row", "write lines " + form);
  return rows;
}

TextRow text_row(const std::filesystem::path& file, const FieldRow& row) {
  return {file, row.line, {row.fields.begin(), row.fields.end()}};
}

}  // namespace

PoseStream read_pose_stream(const std::filesystem::path& file) {
  const std::string form = "t x y z qx qy qz qw";
  PoseStream stream;
  int repeated = 0;
  for (const FieldRow& fields : timed_rows(file, form)) {
    const TextRow row = text_row(file, fields);
    if (row.fields.size() != 8)
      throw InputError(row.where(), "has " + std::to_string(row.fields.size()) + " fields", "write 8 of them: " + form);
    const RobotTime time = time_field(row, 0);
    if (!stream.samples.empty() && time == stream.samples.back().time) {
      ++repeated;
      continue;
    }
    if (!stream.samples.empty()) require_ascending(row, stream.samples.back().time, time);
    stream.samples.push_back({time, pose_fields(row, 1)});
  }
  if (repeated > 0)
    stream.notes.push_back(std::to_string(repeated) + " rows repeat the time before them in " + file.string());
  return stream;
}

std::vector<JointRow> read_joint_stream(const std::filesystem::path& file) {
  std::vector<JointRow> rows;
  for (const FieldRow& fields : timed_rows(file, "t q1 q2 ...")) {
    const TextRow row = text_row(file, fields);
    JointRow joints{time_field(row, 0), {}};
    for (std::size_t i = 1; i < row.fields.size(); ++i) {
      const auto value = parse_number(row.fields[i]);
      if (!value || !std::isfinite(*value))
        throw InputError(row.where(), in_quotes(row.fields[i]) + " is not a finite number",
                         "correct or remove the line");
      joints.positions.push_back(*value);
    }
    if (joints.positions.empty() || (!rows.empty() && joints.positions.size() != rows[0].positions.size()))
      throw InputError(row.where(), "has " + std::to_string(joints.positions.size()) + " joints",
                       "write the time and as many joints in every row");
    if (!rows.empty() && joints.time == rows.back().time) continue;
    if (!rows.empty()) require_ascending(row, rows.back().time, joints.time);
    rows.push_back(std::move(joints));
  }
  return rows;
}

std::vector<PoseTrack::Sample> swept_poses(const std::vector<JointRow>& rows, const std::string& where) {
  if (rows.at(0).positions.size() > 2)
    throw InputError(where, "has " + std::to_string(rows[0].positions.size()) + " joints",
                     "give the robot's --urdf, or the one or two joints that were swept");
  std::vector<PoseTrack::Sample> samples;
  for (const JointRow& row : rows) {
    Pose pose = Pose::Identity();
    pose.rotate(Eigen::AngleAxisd(row.positions[0], Eigen::Vector3d::UnitZ()));
    if (row.positions.size() > 1) pose.rotate(Eigen::AngleAxisd(row.positions[1], Eigen::Vector3d::UnitY()));
    samples.push_back({row.time, pose});
  }
  return samples;
}

}  // namespace foresight

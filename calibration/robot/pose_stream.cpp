#include "calibration/robot/pose_stream.hpp"

#include <cmath>

#include "calibration/robot/rigid_math.hpp"
#include "calibration/robot/robot_poses.hpp"
#include "common/counted.hpp"
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

/// Nanoseconds in one of the unit.
std::int64_t nanoseconds_in(TimeUnit unit) {
  switch (unit) {
    case TimeUnit::nanosecond: return 1;
    case TimeUnit::microsecond: return 1'000;
    case TimeUnit::millisecond: return 1'000'000;
    default: return 1'000'000'000;
  }
}

const char* name_of(TimeUnit unit) {
  switch (unit) {
    case TimeUnit::nanosecond: return "nanoseconds";
    case TimeUnit::microsecond: return "microseconds";
    case TimeUnit::millisecond: return "milliseconds";
    default: return "seconds";
  }
}

TimeUnit likely_unit(const std::vector<FieldRow>& rows) {
  std::vector<double> times, steps;
  for (const FieldRow& row : rows)
    if (const auto time = parse_number(row.fields[0]); time && std::isfinite(*time)) times.push_back(*time);
  for (std::size_t i = 1; i < times.size(); ++i)
    if (times[i] > times[i - 1]) steps.push_back(times[i] - times[i - 1]);
  if (times.empty()) return TimeUnit::second;
  constexpr double kUnixEra = 1e8;  // seconds: 1973
  if (times[0] > 1e9 * kUnixEra) return TimeUnit::nanosecond;
  if (times[0] > 1e6 * kUnixEra) return TimeUnit::microsecond;
  if (times[0] > 1e3 * kUnixEra) return TimeUnit::millisecond;
  if (steps.empty()) return TimeUnit::second;
  const double step = median(steps);
  return step < 4     ? TimeUnit::second
         : step < 4e3 ? TimeUnit::millisecond
         : step < 4e6 ? TimeUnit::microsecond
                      : TimeUnit::nanosecond;
}

RobotTime time_of(const TextRow& row, TimeUnit unit) {
  if (unit == TimeUnit::second) return time_field(row, 0);
  constexpr std::int64_t kLatest = kLargestSeconds * 1'000'000'000;
  const std::string text(row.fields[0]);
  const std::int64_t scale = nanoseconds_in(unit);
  if (const auto whole = parse_integer(text); whole && std::abs(*whole) <= kLatest / scale)
    return RobotTime{*whole * scale};
  if (const auto time = parse_number(text); time && std::abs(*time) <= static_cast<double>(kLatest / scale))
    return RobotTime{std::llround(*time * static_cast<double>(scale))};
  throw InputError(row.where(), "time is " + in_quotes(text) + ", not a number of " + name_of(unit),
                   "write one unit in every row, or name it by --time-unit");
}

/// `unit`, or the likely one with a note.
TimeUnit unit_of(const std::filesystem::path& file, const std::vector<FieldRow>& rows, TimeUnit unit,
                 std::vector<std::string>& notes) {
  if (unit != TimeUnit::automatic) return unit;
  unit = likely_unit(rows);
  if (unit != TimeUnit::second)
    notes.push_back("the times of " + file.string() + " are taken as " + name_of(unit) +
                    "; say --time-unit if that is wrong");
  return unit;
}

}  // namespace

PoseStream read_pose_stream(const std::filesystem::path& file, TimeUnit unit) {
  const std::string form = "t x y z qx qy qz qw";
  PoseStream stream;
  int repeated = 0;
  const std::vector<FieldRow> rows = timed_rows(file, form);
  unit = unit_of(file, rows, unit, stream.notes);
  for (const FieldRow& fields : rows) {
    const TextRow row = text_row(file, fields);
    if (row.fields.size() != 8)
      throw InputError(row.where(), "has " + counted(row.fields.size(), "field"), "write 8 of them: " + form);
    const RobotTime time = time_of(row, unit);
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

JointStream read_joint_stream(const std::filesystem::path& file, TimeUnit unit) {
  JointStream stream;
  std::vector<JointRow>& rows = stream.rows;
  const std::vector<FieldRow> all = timed_rows(file, "t q1 q2 ...");
  unit = unit_of(file, all, unit, stream.notes);
  for (const FieldRow& fields : all) {
    const TextRow row = text_row(file, fields);
    JointRow joints{time_of(row, unit), {}};
    for (std::size_t i = 1; i < row.fields.size(); ++i) {
      const auto value = parse_number(row.fields[i]);
      if (!value || !std::isfinite(*value))
        throw InputError(row.where(), in_quotes(row.fields[i]) + " is not a finite number",
                         "correct or remove the line");
      joints.positions.push_back(*value);
    }
    if (joints.positions.empty() || (!rows.empty() && joints.positions.size() != rows[0].positions.size()))
      throw InputError(row.where(), "has " + counted(joints.positions.size(), "joint"),
                       "write the time and as many joints in every row");
    if (!rows.empty() && joints.time == rows.back().time) continue;
    if (!rows.empty()) require_ascending(row, rows.back().time, joints.time);
    rows.push_back(std::move(joints));
  }
  return stream;
}

std::vector<PoseTrack::Sample> swept_poses(const std::vector<JointRow>& rows, const std::string& where) {
  if (rows.at(0).positions.size() > 2)
    throw InputError(where, "has " + counted(rows[0].positions.size(), "joint"),
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

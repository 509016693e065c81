#include "apps/bench/pose_table.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "apps/bench/time_column.hpp"
#include "common/error.hpp"
#include "common/text.hpp"
#include "common/text_rows.hpp"

namespace foresight {
namespace {

constexpr std::array kParts{"x", "y", "z", "qx", "qy", "qz", "qw"};

struct PoseColumns {
  std::size_t count = 0;
  std::optional<TimeColumn> time;
  std::vector<std::array<std::size_t, kParts.size()>> poses;  // of the table's series
};

PoseColumns read_header(const TextRow& line, PoseTable& table) {
  const std::vector<std::string> names(line.fields.begin(), line.fields.end());
  const auto find = [&](const std::string& name) {
    return static_cast<std::size_t>(std::ranges::find(names, name) - names.begin());
  };
  PoseColumns columns{names.size(), TimeColumn::find(names), {}};
  for (const std::string& name : names) {
    if (!name.ends_with("qw")) continue;
    const std::string prefix = name.substr(0, name.size() - 2);
    std::array<std::size_t, kParts.size()> pose{};
    for (std::size_t i = 0; i < kParts.size(); ++i) pose[i] = find(prefix + kParts[i]);
    if (std::ranges::find(pose, names.size()) != pose.end()) continue;
    columns.poses.push_back(pose);
    table.series.push_back({prefix, {}});
  }
  if (!columns.time || columns.poses.empty())
    throw InputError(line.where(),
                     "names no time_s (or timestamp) or no pose (x y z qx qy qz qw, perhaps after a prefix)",
                     "write the names of the columns in the first line");
  return columns;
}

double number_field(const TextRow& line, std::size_t field) {
  const auto number = parse_number(line.fields[field]);
  if (!number)
    throw InputError(line.where(field), in_quotes(line.fields[field]) + " is no number",
                     "correct it, or write nan where the tracker had lost the pose");
  return *number;
}

std::optional<Pose> read_pose(const TextRow& line, const std::array<std::size_t, kParts.size()>& at) {
  std::array<double, kParts.size()> n{};
  bool finite = true;
  for (std::size_t i = 0; i < n.size(); ++i) {
    n[i] = number_field(line, at[i]);
    finite = finite && std::isfinite(n[i]);
  }
  const Eigen::Quaterniond q(n[6], n[3], n[4], n[5]);
  if (!finite || !(std::abs(q.norm() - 1) < 0.01)) return {};
  Pose T = Pose::Identity();
  T.linear() = q.normalized().toRotationMatrix();
  T.translation() = Eigen::Vector3d(n[0], n[1], n[2]);
  return T;
}

}  // namespace

PoseTable read_pose_table(const std::filesystem::path& csv) {
  PoseTable table;
  PoseColumns columns;
  std::int64_t first = 0;
  for_each_row(csv, {RowForm::Between::commas}, [&](const TextRow& line) {
    if (columns.count == 0) {
      columns = read_header(line, table);
      return;
    }
    if (line.fields.size() != columns.count)
      throw InputError(line.where(), "has " + std::to_string(line.fields.size()) + " fields",
                       "write " + std::to_string(columns.count) + ", as the first line has");
    const std::int64_t time = columns.time->read(line);
    if (table.time_ns.empty()) first = time;
    const std::int64_t since = time - first;
    const bool repeated = !table.time_ns.empty() && since == table.time_ns.back();
    for (std::size_t i = 0; i < table.series.size(); ++i) {
      const auto pose = read_pose(line, columns.poses[i]);
      if (!repeated) table.series[i].poses.push_back(pose);
    }
    table.repeated += repeated;
    if (!repeated) table.time_ns.push_back(since);
  });
  if (table.time_ns.empty()) throw InputError(csv.string(), "has no row", "name a recording");
  return table;
}

const PoseSeries& head_of(const PoseTable& table) {
  for (const char* prefix : {"", "head_"})
    for (const PoseSeries& series : table.series)
      if (series.prefix == prefix) return series;
  return table.series.front();
}

PoseTrack head_track(const PoseTable& table) {
  const PoseSeries& head = head_of(table);
  std::vector<PoseTrack::Sample> samples;
  for (std::size_t i = 0; i < head.poses.size(); ++i)
    if (head.poses[i]) samples.push_back({RobotTime{table.time_ns[i]}, *head.poses[i]});
  return PoseTrack(std::move(samples));
}

}  // namespace foresight

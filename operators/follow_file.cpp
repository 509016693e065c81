#include "operators/follow_file.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "common/error.hpp"
#include "common/text.hpp"
#include "common/text_rows.hpp"

namespace foresight {
namespace {

std::vector<std::size_t> columns_of(const TextRow& row, const Rig& rig) {
  const std::vector<std::string> known = rig.joint_names();
  const auto& names = row.fields;
  if (names.size() < 2 || names.front() != "time_s")
    throw InputError(row.where(), "the first line is no heading",
                     "begin with `time_s,` and names of joints, such as " + known.front());
  std::vector<std::size_t> out;
  for (std::size_t i = 1; i < names.size(); ++i) {
    const auto found = std::find(known.begin(), known.end(), names[i]);
    if (found == known.end())
      throw InputError(row.where(i), "the rig has no joint " + in_quotes(names[i]), did_you_mean(names[i], known));
    const auto joint = static_cast<std::size_t>(found - known.begin());
    if (std::find(out.begin(), out.end(), joint) != out.end())
      throw InputError(row.where(i), "joint " + in_quotes(names[i]) + " has two columns", "remove one");
    out.push_back(joint);
  }
  return out;
}

constexpr double kHardlyMoves = 0.01;  // of what a joint may do: as if times in ms were taken for seconds

}  // namespace

FollowFile::FollowFile(const std::filesystem::path& file, const Rig& rig) : words_(rig.joint_words()) {
  for_each_row(file, {RowForm::Between::commas}, [&](const TextRow& row) {
    if (joints_.empty())
      joints_ = columns_of(row, rig);
    else
      add(row, rig);
  });
  if (rows_.empty())
    throw InputError(file.string(), "has no positions", "give rows of a time and positions below the heading");
}

void FollowFile::add(const TextRow& row, const Rig& rig) {
  if (row.fields.size() != joints_.size() + 1)
    throw InputError(row.where(), "has " + std::to_string(row.fields.size()) + " fields",
                     "give " + std::to_string(joints_.size() + 1));
  const double time = finite_field(row, 0, "time_s");
  if (!times_.empty() && time <= times_.back())
    throw InputError(row.where(), "its time does not lie after the row before", "sort the rows by time_s");
  std::vector<double> positions;
  for (std::size_t i = 0; i < joints_.size(); ++i) {
    const RigJoint& joint = rig.joints[joints_[i]];
    const double q = finite_field(row, i + 1, joint.drive.name);
    if (q < joint.drive.min_position || q > joint.drive.max_position)
      throw InputError(row.where(i + 1),
                       "joint '" + joint.drive.name + "' at " + std::string(row.fields[i + 1]) + " " + joint.unit +
                           " is beyond its limits",
                       "choose from " + std::to_string(joint.drive.min_position) + " to " +
                           std::to_string(joint.drive.max_position));
    const double share =
        rows_.empty() ? 0 : std::abs(q - rows_.back()[i]) / (joint.drive.max_velocity * (time - times_.back()));
    if (share > 1.001)
      throw InputError(row.where(i + 1),
                       "joint '" + joint.drive.name + "' would move faster than " +
                           std::to_string(joint.drive.max_velocity) + " " + joint.unit + "/s",
                       "give it more time");
    fastest_ = std::max(fastest_, share);
    positions.push_back(q);
  }
  times_.push_back(time);
  rows_.push_back(std::move(positions));
}

void FollowFile::at(double seconds, JointValues& positions) const {
  const double t = std::clamp(times_.front() + seconds, times_.front(), times_.back());
  const auto after = static_cast<std::size_t>(std::upper_bound(times_.begin(), times_.end(), t) - times_.begin());
  const std::size_t b = std::min(after, times_.size() - 1), a = b == 0 ? 0 : b - 1;
  const double share = a == b ? 0 : std::clamp((t - times_[a]) / (times_[b] - times_[a]), 0.0, 1.0);
  for (std::size_t i = 0; i < joints_.size(); ++i)
    positions[joints_[i]] = rows_[a][i] + share * (rows_[b][i] - rows_[a][i]);
}

std::vector<std::string> words_on_start(const FollowFile& file) {
  std::vector<std::string> out{"the motion of the file takes " + readable(file.duration_s(), 2, " s")};
  if (file.fastest() > 0 && file.fastest() < kHardlyMoves)
    out.push_back(
        fmt::format("no joint gets faster than {:.1g} % of what it may: time_s counts seconds, not milliseconds",
                    100 * file.fastest()));
  return out;
}

}  // namespace foresight

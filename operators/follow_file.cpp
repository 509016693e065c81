#include "operators/follow_file.hpp"

#include <algorithm>
#include <cmath>
#include <fstream>

#include "common/error.hpp"
#include "common/text.hpp"

namespace foresight {
namespace {

std::vector<std::string> fields_of(std::string line) {
  if (!line.empty() && line.back() == '\r') line.pop_back();
  std::vector<std::string> out;
  for (std::size_t at = 0;;) {
    const std::size_t end = std::min(line.find(',', at), line.size());
    const std::size_t first = std::min(line.find_first_not_of(" \t", at), end);
    std::size_t last = end;
    while (last > first && (line[last - 1] == ' ' || line[last - 1] == '\t')) --last;
    out.push_back(line.substr(first, last - first));
    if (end == line.size()) return out;
    at = end + 1;
  }
}

std::vector<std::size_t> columns_of(const std::vector<std::string>& names, const Rig& rig, const std::string& where) {
  const std::vector<std::string> known = rig.joint_names();
  if (names.size() < 2 || names.front() != "time_s")
    throw InputError(where, "the first line is no heading",
                     "begin with `time_s,` and names of joints, such as " + known.front());
  std::vector<std::size_t> out;
  for (std::size_t i = 1; i < names.size(); ++i) {
    const auto found = std::find(known.begin(), known.end(), names[i]);
    if (found == known.end())
      throw InputError(where, "the rig has no joint " + in_quotes(names[i]),
                       "did you mean '" + nearest_word(names[i], known) + "'?");
    const auto joint = static_cast<std::size_t>(found - known.begin());
    if (std::find(out.begin(), out.end(), joint) != out.end())
      throw InputError(where, "joint " + in_quotes(names[i]) + " has two columns", "remove one");
    out.push_back(joint);
  }
  return out;
}

}  // namespace

FollowFile::FollowFile(const std::filesystem::path& file, const Rig& rig) {
  std::ifstream stream(file);
  if (!stream) throw InputError(file.string(), "cannot be read", "give a CSV file with the columns time_s and joints");
  std::string line;
  for (int number = 1; std::getline(stream, line); ++number) {
    if (line.empty() || line[0] == '#' || line == "\r") continue;
    const std::string where = at_line(file, number);
    const auto fields = fields_of(line);
    if (joints_.empty()) {
      joints_ = columns_of(fields, rig, where);
      continue;
    }
    if (fields.size() != joints_.size() + 1)
      throw InputError(where, "has " + std::to_string(fields.size()) + " fields",
                       "give " + std::to_string(joints_.size() + 1));
    std::vector<double> values;
    for (const std::string& field : fields) {
      const auto value = parse_number(field);
      if (!value || !std::isfinite(*value)) throw InputError(where, in_quotes(field) + " is no number", "correct it");
      values.push_back(*value);
    }
    if (!times_.empty() && values[0] <= times_.back())
      throw InputError(where, "its time does not lie after the row before", "sort the rows by time_s");
    for (std::size_t i = 0; i < joints_.size(); ++i) {
      const RigJoint& joint = rig.joints[joints_[i]];
      const double q = values[i + 1];
      if (q < joint.drive.min_position || q > joint.drive.max_position)
        throw InputError(
            where, "joint '" + joint.drive.name + "' at " + fields[i + 1] + " " + joint.unit + " is beyond its limits",
            "choose from " + std::to_string(joint.drive.min_position) + " to " +
                std::to_string(joint.drive.max_position));
      if (!rows_.empty() &&
          std::abs(q - rows_.back()[i]) > 1.001 * joint.drive.max_velocity * (values[0] - times_.back()))
        throw InputError(where,
                         "joint '" + joint.drive.name + "' would move faster than " +
                             std::to_string(joint.drive.max_velocity) + " " + joint.unit + "/s",
                         "give it more time");
    }
    times_.push_back(values[0]);
    rows_.emplace_back(values.begin() + 1, values.end());
  }
  if (rows_.empty())
    throw InputError(file.string(), "has no positions", "give rows of a time and positions below the heading");
}

void FollowFile::at(double seconds, JointValues& positions) const {
  const double t = std::clamp(times_.front() + seconds, times_.front(), times_.back());
  const auto after = static_cast<std::size_t>(std::upper_bound(times_.begin(), times_.end(), t) - times_.begin());
  const std::size_t b = std::min(after, times_.size() - 1), a = b == 0 ? 0 : b - 1;
  const double share = a == b ? 0 : std::clamp((t - times_[a]) / (times_[b] - times_[a]), 0.0, 1.0);
  for (std::size_t i = 0; i < joints_.size(); ++i)
    positions[joints_[i]] = rows_[a][i] + share * (rows_[b][i] - rows_[a][i]);
}

}  // namespace foresight

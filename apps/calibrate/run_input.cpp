#include "apps/calibrate/run_input.hpp"

#include <algorithm>

#include "calibration/robot/robot_poses.hpp"
#include "common/counted.hpp"
#include "common/error.hpp"
#include "common/text.hpp"
#include "scene/text_table.hpp"

namespace foresight {

namespace fs = std::filesystem;

std::vector<TimedPicture> read_picture_list(const fs::path& list) {
  std::vector<TimedPicture> out;
  for_each_row(list, "time file", [&](const TextRow& row) {
    out.push_back({time_field(row, 0), list.parent_path() / row.fields[1]});
  });
  return out;
}

void require_run(const fs::path& run) {
  if (!fs::is_regular_file(run / "rgb.txt"))
    throw InputError((run / "rgb.txt").string(), "is missing",
                     "give a folder that `foresight robot --record` or `foresight record` wrote");
}

std::vector<std::string> column_names(const fs::path& file) {
  const std::vector<FieldRow> rows = read_field_rows(file);
  if (rows.empty() || parse_number(rows[0].fields.back())) return {};
  return rows[0].fields;
}

std::vector<JointRow> read_named_joints(const fs::path& file, const std::vector<std::string>& names,
                                        const std::string& option) {
  std::vector<JointRow> joints = read_joint_stream(file, TimeUnit::second).rows;
  std::vector<std::string> there = column_names(file);
  if (there.empty()) {
    if (joints[0].positions.size() != names.size())
      throw InputError(file.string(), "has " + counted(joints[0].positions.size(), "joint") + " without names",
                       "begin it with a row of names, such as time_s," + names.front() + ",...");
    return joints;
  }
  there.erase(there.begin());
  std::vector<std::size_t> column;
  for (const std::string& name : names) {
    const auto at = std::find(there.begin(), there.end(), name);
    if (at == there.end())
      throw InputError(file.string(), "has no joint " + in_quotes(name),
                       "name the joints as they are there with " + option + "; " + did_you_mean(name, there));
    column.push_back(static_cast<std::size_t>(at - there.begin()));
  }
  for (JointRow& row : joints) {
    std::vector<double> wanted;
    for (const std::size_t c : column) wanted.push_back(row.positions[c]);
    row.positions = std::move(wanted);
  }
  return joints;
}

}  // namespace foresight

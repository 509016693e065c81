// Recorded joints: commanded or measured positions over time, one row per instant.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace foresight {

struct JointColumn {
  std::string name;
  std::vector<double> values;  ///< one per row
};

struct JointTable {
  std::vector<std::int64_t> time_ns;  ///< strictly ascending, of the file's own clock
  std::vector<JointColumn> columns;   ///< q1, q2, ... and dq1, dq2, ... where there are such; else all but the time
  std::size_t repeated = 0;           ///< rows left out because they had the time of the one before

  const JointColumn* find(const std::string& name) const;
};

/// Reads a CSV whose first line names `time_s` or `timestamp` and further columns. Throws InputError naming file, line
/// and cure: no time, nothing beside it, no row, a field that is no finite number, another number of fields, a time
/// before that of the line before, columns of one name.
JointTable read_joint_table(const std::filesystem::path& csv);

}  // namespace foresight

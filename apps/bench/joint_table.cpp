#include "apps/bench/joint_table.hpp"

#include <algorithm>
#include <optional>

#include "apps/bench/time_column.hpp"
#include "common/error.hpp"
#include "common/text.hpp"
#include "common/text_rows.hpp"

namespace foresight {
namespace {

struct JointColumns {
  std::size_t count = 0;
  std::optional<TimeColumn> time;
  std::vector<std::size_t> fields;  // of the table's columns
};

// "q12" with the prefix "q".
bool is_numbered(std::string_view name, std::string_view prefix) {
  if (!name.starts_with(prefix) || name.size() == prefix.size()) return false;
  name.remove_prefix(prefix.size());
  return std::ranges::all_of(name, [](char c) { return c >= '0' && c <= '9'; });
}

JointColumns read_header(const TextRow& line, JointTable& table) {
  const std::vector<std::string> names(line.fields.begin(), line.fields.end());
  JointColumns columns{names.size(), TimeColumn::find(names), {}};
  if (!columns.time || names.size() < 2)
    throw InputError(line.where(), "names no time_s (or timestamp), or no column beside it",
                     "write the names of the columns in the first line: time_s,q1,q2,...");
  const auto is_joint = [](const std::string& name) { return is_numbered(name, "q") || is_numbered(name, "dq"); };
  const bool numbered = std::ranges::any_of(names, is_joint);
  for (std::size_t i = 0; i < names.size(); ++i) {
    if (i == columns.time->index() || (numbered && !is_joint(names[i]))) continue;
    if (table.find(names[i]))
      throw InputError(line.where(i), "a second column is called " + in_quotes(names[i]), "give each its own name");
    table.columns.push_back({names[i], {}});
    columns.fields.push_back(i);
  }
  return columns;
}

}  // namespace

const JointColumn* JointTable::find(const std::string& name) const {
  const auto at = std::ranges::find(columns, name, &JointColumn::name);
  return at == columns.end() ? nullptr : &*at;
}

JointTable read_joint_table(const std::filesystem::path& csv) {
  JointTable table;
  JointColumns columns;
  for_each_row(csv, {RowForm::Between::commas}, [&](const TextRow& line) {
    if (!columns.time) {
      columns = read_header(line, table);
      return;
    }
    if (line.fields.size() != columns.count)
      throw InputError(line.where(), "has " + std::to_string(line.fields.size()) + " fields",
                       "write " + std::to_string(columns.count) + ", as the first line has");
    const std::int64_t now = columns.time->read(line);
    const bool repeated = !table.time_ns.empty() && now == table.time_ns.back();
    for (std::size_t i = 0; i < table.columns.size(); ++i) {
      const double value = finite_field(line, columns.fields[i], table.columns[i].name);
      if (!repeated) table.columns[i].values.push_back(value);
    }
    table.repeated += repeated;
    if (!repeated) table.time_ns.push_back(now);
  });
  if (table.time_ns.empty()) throw InputError(csv.string(), "has no row", "name a recording");
  return table;
}

}  // namespace foresight

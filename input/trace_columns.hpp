// Columns of a recording by their names, for those who read one.
#pragma once

#include <initializer_list>
#include <map>
#include <string>

#include "common/text_rows.hpp"
#include "scene/scene_model.hpp"

namespace foresight {

class TraceColumns {
 public:
  TraceColumns() = default;
  explicit TraceColumns(const TextRow& heading);

  bool has(const std::string& name) const { return columns_.contains(name); }
  bool has_all(std::initializer_list<const char*> names) const;
  /// Throw InputError at the field: no number; `number` also where it is not finite; a row that is shorter than its
  /// heading. A column that is not there is a mistake of the program.
  double number(const TextRow& row, const std::string& name) const;
  double number_or_nan(const TextRow& row, const std::string& name) const;
  Duration seconds_since(const TextRow& row, const std::string& name) const;
  /// Of `prefix` + x y z qx qy qz qw. Throws InputError: a quaternion that is none.
  Pose pose(const TextRow& row, const std::string& prefix) const;
  /// 0 or 1.
  bool flag(const TextRow& row, const std::string& name) const { return number(row, name) != 0; }

 private:
  std::size_t place(const TextRow& row, const std::string& name) const;
  std::map<std::string, std::size_t> columns_;
};

}  // namespace foresight

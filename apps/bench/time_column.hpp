// The column of a recording that says when.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>

#include "common/text_rows.hpp"

namespace foresight {

/// `time_s` (seconds) or `timestamp` (nanoseconds, or ticks of 100 ns since the year 1 as Windows counts them).
class TimeColumn {
 public:
  /// Nothing where no such column is named.
  static std::optional<TimeColumn> find(std::span<const std::string> names);

  std::size_t index() const { return index_; }
  /// Nanoseconds since an instant of the file's own. Throws InputError naming file, line, column and cure: no number,
  /// or a time before that of the row before.
  std::int64_t read(const TextRow& row);

 private:
  std::size_t index_ = 0;
  bool seconds_ = true;
  std::optional<std::int64_t> before_;
};

}  // namespace foresight

#include "apps/bench/time_column.hpp"

#include <algorithm>
#include <cmath>

#include "common/error.hpp"
#include "common/text.hpp"

namespace foresight {
namespace {

// Ticks of these years would be nanoseconds since 1970 of August 1989 to November 1990.
constexpr std::int64_t kFirstTick = 620'000'000'000'000'000, kLastTick = 660'000'000'000'000'000;
constexpr std::int64_t kLargest = 4'000'000'000'000'000'000;  // ns either way: differences do not overflow

std::optional<std::int64_t> parse_stamp(std::string_view text) {
  std::optional<std::int64_t> stamp = parse_integer(text);
  if (!stamp) {
    const auto number = parse_number(text);
    if (number && std::abs(*number) <= static_cast<double>(kLargest)) stamp = std::llround(*number);
  }
  if (stamp && *stamp >= kFirstTick && *stamp <= kLastTick) stamp = (*stamp - kFirstTick) * 100;
  if (stamp && (*stamp > kLargest || *stamp < -kLargest)) stamp.reset();
  return stamp;
}

}  // namespace

std::optional<TimeColumn> TimeColumn::find(std::span<const std::string> names) {
  TimeColumn column;
  for (const bool seconds : {true, false}) {
    const auto at = std::ranges::find(names, seconds ? "time_s" : "timestamp");
    if (at == names.end()) continue;
    column.index_ = static_cast<std::size_t>(at - names.begin());
    column.seconds_ = seconds;
    return column;
  }
  return {};
}

std::int64_t TimeColumn::read(const TextRow& row) {
  const std::string_view text = row.fields[index_];
  std::optional<std::int64_t> time;
  if (seconds_) {
    if (const auto since = parse_seconds(text)) time = since->count();
    if (!time)
      throw InputError(row.where(index_), "time_s is " + in_quotes(text) + ", no number of seconds",
                       "write seconds, at most " + std::to_string(kLargestSeconds));
  } else {
    time = parse_stamp(text);
    if (!time)
      throw InputError(row.where(index_), "timestamp is " + in_quotes(text) + ", no number of nanoseconds",
                       "write nanoseconds, or seconds in a column time_s");
  }
  if (before_ && *time < *before_)
    throw InputError(row.where(index_), "its time is not after the one before", "sort the rows by time");
  before_ = time;
  return *time;
}

}  // namespace foresight

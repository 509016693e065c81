#include "prediction/position_history.hpp"

#include <algorithm>
#include <cmath>

namespace foresight {

bool PositionHistory::add(double time, double position) noexcept {
  if (!std::isfinite(time) || !std::isfinite(position)) return false;
  if (!values_.empty() && !(time > values_.newest().time)) return false;
  values_.next() = {time, position};
  return true;
}

// The first value whose time is after `time`; size() where there is none. Values come nearly evenly: it is sought from
// where it would be if they did, in steps that double, and by halves within the last of these.
std::size_t PositionHistory::first_after(double time) const noexcept {
  const std::size_t size = values_.size();
  if (size == 0 || !(values_.newest().time > time)) return size;
  if (values_[0].time > time) return 0;
  const double share = (time - values_[0].time) / (values_.newest().time - values_[0].time);
  std::size_t from = static_cast<std::size_t>(share * static_cast<double>(size - 1)), to = from + 1;
  for (std::size_t step = 1; to < size && values_[to].time <= time; step *= 2) {
    from = to;
    to = std::min(size, to + step);
  }
  for (std::size_t step = 1; from > 0 && values_[from].time > time; step *= 2) {
    to = from;
    from -= std::min(from, step);
  }
  std::size_t count = to - from;
  while (count > 0) {
    const std::size_t half = count / 2;
    if (values_[from + half].time > time) {
      count = half;
    } else {
      from += half + 1;
      count -= half + 1;
    }
  }
  return from;
}

double PositionHistory::at(double time, double until, double sparse) const noexcept {
  const std::size_t after = first_after(std::min(time, until));
  if (after == 0) return values_[0].position;
  const TimedPosition& before = values_[after - 1];
  if (after == values_.size()) return before.position;
  const TimedPosition& next = values_[after];
  if (next.time > until || next.time - before.time > sparse) return before.position;
  return std::lerp(before.position, next.position, (time - before.time) / (next.time - before.time));
}

bool PositionHistory::covers(double time, double gap) const noexcept {
  const std::size_t after = first_after(time);
  if (after == 0) return false;
  if (after == values_.size()) return values_.newest().time == time;
  return values_[after].time - values_[after - 1].time <= gap;
}

std::optional<TimedPosition> PositionHistory::measured_about(double time, double within) const noexcept {
  if (covers(time, kSparse)) return TimedPosition{time, at(time)};
  if (empty()) return {};
  const TimedPosition& value = nearest_value(time);
  return std::abs(value.time - time) <= within ? std::optional(value) : std::nullopt;
}

const TimedPosition& PositionHistory::nearest_value(double time) const noexcept {
  const std::size_t after = first_after(time);
  if (after == 0) return values_[0];
  if (after == values_.size()) return values_.newest();
  return values_[after].time - time < time - values_[after - 1].time ? values_[after] : values_[after - 1];
}

}  // namespace foresight

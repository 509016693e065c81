#include "sim/drives/shaft_history.hpp"

#include <algorithm>
#include <ranges>

namespace foresight::sim {

ShaftHistory::ShaftHistory(std::size_t shafts, std::size_t steps)
    : shafts_(shafts), times_(steps), positions_(shafts * steps) {}

void ShaftHistory::add(RobotTime time, std::span<const double> positions) {
  times_[next_] = time;
  std::copy_n(positions.begin(), shafts_, positions_.begin() + static_cast<std::ptrdiff_t>(next_ * shafts_));
  next_ = (next_ + 1) % times_.size();
  count_ = std::min(count_ + 1, times_.size());
}

std::size_t ShaftHistory::place(std::size_t age) const {
  return (next_ + times_.size() - count_ + age) % times_.size();
}

double ShaftHistory::at(std::size_t shaft, RobotTime time) const {
  const auto steps = std::views::iota(std::size_t{0}, count_);
  const auto after = static_cast<std::size_t>(
      std::ranges::upper_bound(steps, time, {}, [&](std::size_t age) { return times_[place(age)]; }) - steps.begin());
  const auto position = [&](std::size_t age) { return positions_[place(age) * shafts_ + shaft]; };
  if (after == 0) return position(0);
  if (after == count_) return position(count_ - 1);
  const RobotTime a = times_[place(after - 1)], b = times_[place(after)];
  return std::lerp(position(after - 1), position(after), to_seconds(time - a) / to_seconds(b - a));
}

}  // namespace foresight::sim

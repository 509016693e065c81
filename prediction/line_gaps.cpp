#include "prediction/line_gaps.hpp"

#include <algorithm>
#include <array>

namespace foresight {
namespace {

constexpr double kTogether = 5e-3;  // what was held up came at once, and was waited for once
constexpr double kRemembered = 60;
constexpr double kRise = 0.2, kFall = kRise * 0.05 / 0.95;  // a quantile rises seldom by much, falls often by little

}  // namespace

void LineGaps::add(double gap, double now) noexcept {
  if (gap < kTogether) return;
  usual_ = std::clamp(usual_ * (gap > usual_ ? 1 + kRise : 1 - kFall), 0.01, longest_);
  newest_ = now;
  if (gap >= kNotable) notable_.next() = {gap, now};
}

double LineGaps::chance_to_reach(double length, double so_far) const noexcept {
  double as_long = 0, reached = 0;
  for (std::size_t i = 0; i < notable_.size(); ++i) {
    const Gap& gap = notable_[i];
    if (newest_ - gap.ended > kRemembered || gap.length < so_far) continue;
    ++as_long;
    if (gap.length >= length) ++reached;
  }
  return (reached + 0.5) / (as_long + 1);
}

double LineGaps::expected_length(double so_far) const noexcept {
  std::array<double, kKept + 1> lengths{2 * so_far};
  auto end = lengths.begin() + 1;
  for (std::size_t i = 0; i < notable_.size(); ++i)
    if (newest_ - notable_[i].ended <= kRemembered && notable_[i].length >= so_far) *end++ = notable_[i].length;
  const auto middle = lengths.begin() + (end - lengths.begin()) / 2;
  std::nth_element(lengths.begin(), middle, end);
  return *middle;
}

}  // namespace foresight

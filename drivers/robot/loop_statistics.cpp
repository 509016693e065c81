#include "drivers/robot/loop_statistics.hpp"

#include <algorithm>
#include <cmath>

namespace foresight {

void LoopStatistics::count(Duration late, Duration period) noexcept {
  ++cycles_;
  if (late >= period) ++overruns_;
  worst_ = std::max(worst_, late);
  const double ns = std::max(1.0, static_cast<double>(late.count()));
  ++buckets_[static_cast<std::size_t>(std::clamp(static_cast<int>(kPerOctave * std::log2(ns)), 0, kBuckets - 1))];
}

Duration LoopStatistics::quantile(double share) const noexcept {
  const double wanted = share * static_cast<double>(cycles_);
  double seen = 0;
  for (int i = 0; i < kBuckets; ++i) {
    seen += buckets_[static_cast<std::size_t>(i)];
    if (seen >= wanted && seen > 0) return std::min(worst_, Duration{std::llround(std::exp2((i + 1.0) / kPerOctave))});
  }
  return worst_;
}

}  // namespace foresight

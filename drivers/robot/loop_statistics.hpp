// How punctual a periodic loop is.
#pragma once

#include <array>
#include <cstdint>

#include "common/time.hpp"

namespace foresight {

/// Lateness of each wake-up, in a histogram of fixed size. One thread; a copy may go to others.
class LoopStatistics {
 public:
  /// `late`: from when the cycle was due to when it began; `period`: above which later cycles were skipped.
  void count(Duration late, Duration period) noexcept;

  std::uint64_t cycles() const { return cycles_; }
  std::uint64_t overruns() const { return overruns_; }  ///< cycles that began a whole period late, or more
  Duration worst() const { return worst_; }
  /// Upper end of the bucket in which the given share (0 .. 1) of all cycles is reached; buckets are an eighth wide.
  Duration quantile(double share) const noexcept;

 private:
  static constexpr int kPerOctave = 8, kBuckets = 32 * kPerOctave;
  std::array<std::uint32_t, kBuckets> buckets_{};
  std::uint64_t cycles_ = 0, overruns_ = 0;
  Duration worst_{};
};

}  // namespace foresight

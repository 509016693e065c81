// A joint's positions over time: commanded, or measured.
#pragma once

#include <cmath>
#include <limits>
#include <optional>

#include "prediction/last_of.hpp"

namespace foresight {

/// rad or m; s since an instant of the caller's.
struct TimedPosition {
  double time = 0, position = 0;
};

/// The last of a joint's positions over time, commanded or measured. One thread; allocates at the start only.
class PositionHistory {
 public:
  static constexpr double kSparse = 0.055;  ///< s
  explicit PositionHistory(std::size_t most) : values_(most) {}

  /// False, and not taken: not finite, or not after the one before.
  bool add(double time, double position) noexcept;
  /// Those later than `time` were only expected: others will come in their place.
  void forget_after(double time) noexcept {
    while (!values_.empty() && values_.newest().time > time) values_.drop_newest();
  }
  void clear() noexcept { values_.clear(); }
  bool empty() const noexcept { return values_.empty(); }
  const LastOf<TimedPosition>& values() const noexcept { return values_; }
  /// Of those up to `until`, as if there were no others: linear between two that are `sparse` apart at most, else the
  /// earlier one (a step); before the first and after the last, that one. Not empty.
  double at(double time, double until = std::numeric_limits<double>::infinity(),
            double sparse = kSparse) const noexcept;
  /// Whether values on both sides of `time` are no farther apart than `gap`.
  bool covers(double time, double gap) const noexcept;
  /// What was measured at `time`: on the line between values on both sides, or, where these are farther apart than
  /// kSparse, as over a thin line, and what lies between them is not known, the nearer one. Nothing where none is
  /// within `within`.
  std::optional<TimedPosition> measured_about(double time, double within) const noexcept;
  /// How far in time the nearest value is. Not empty.
  double nearest(double time) const noexcept { return std::abs(nearest_value(time).time - time); }

 private:
  std::size_t first_after(double time) const noexcept;
  const TimedPosition& nearest_value(double time) const noexcept;

  LastOf<TimedPosition> values_;
};

}  // namespace foresight

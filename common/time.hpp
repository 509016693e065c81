// Points in time that know their clock.
//
// Two hosts have two clocks. Time<RobotClock> and Time<OperatorClock> are different types,
// so that an instant of one is never compared with an instant of the other by accident.
#pragma once

#include <chrono>
#include <cmath>
#include <compare>
#include <cstdint>

namespace foresight {

using Duration = std::chrono::nanoseconds;

struct RobotClock {};     ///< monotonic clock of the robot's host; stamps images and joints
struct OperatorClock {};  ///< monotonic clock of the operator's host; stamps commands and frames

/// An instant on one clock, as nanoseconds since that clock's own (arbitrary) epoch.
template <typename Clock>
struct Time {
  std::int64_t ns = 0;

  friend constexpr auto operator<=>(Time, Time) = default;
  friend constexpr Duration operator-(Time a, Time b) { return Duration{a.ns - b.ns}; }
  friend constexpr Time operator+(Time t, Duration d) { return {t.ns + d.count()}; }
  friend constexpr Time operator-(Time t, Duration d) { return {t.ns - d.count()}; }
};

using RobotTime = Time<RobotClock>;
using OperatorTime = Time<OperatorClock>;

/// Seconds as a nanosecond duration, rounded to nearest; `seconds` must be finite.
inline Duration seconds(double seconds) {
  return Duration{std::llround(seconds * 1e9)};
}
inline double to_seconds(Duration d) {
  return static_cast<double>(d.count()) * 1e-9;
}

}  // namespace foresight

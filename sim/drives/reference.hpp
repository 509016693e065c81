// How an emulated drive makes a smooth reference of what it is told: profiles, and cyclic set-points.
//
// Joint units. Plain arithmetic, one thread.
#pragma once

#include <optional>

#include "sim/drives/motor.hpp"

namespace foresight::sim {

struct ProfileLimits {
  double velocity = 1, acceleration = 1, deceleration = 1;  ///< > 0
};

/// `from` moved on by `dt` seconds towards rest at `target`, on a trapezoidal profile.
Reference approach(const Reference& from, double target, const ProfileLimits& limits, double dt);
/// `from` moved on by `dt` seconds towards the constant velocity `velocity`; `rate` > 0.
Reference change_speed(const Reference& from, double velocity, double rate, double dt);

/// Cyclic set-points: a uniform quadratic B-spline through the middles of successive set-points. Its acceleration is
/// exactly their second difference, so a drive that interpolates adds none of its own. It lags by one and a half
/// intervals behind an interpolation that would know the next set-point.
///
///     set-points   p0 -------- p1 -------- p2
///     the spline        |==========|             from the middle of p0 p1 to that of p1 p2
class CyclicInterpolator {
 public:
  void start(double position);                    ///< at rest there
  void push(double position, double interval_s);  ///< the next interval begins now; `interval_s` > 0
  /// push(), but where an interval still goes on, after it: set-points that come a little early or late do not disturb
  /// the motion. A second one that waits takes the place of the first.
  void queue(double position, double interval_s);
  Reference step(double dt);  ///< after the interval: onward with its last velocity
  double last() const { return p2_; }
  double extrapolated() const { return 2 * p2_ - p1_; }
  double elapsed_s() const { return elapsed_s_; }
  double interval_s() const { return interval_s_; }
  bool resting() const { return p0_ == p1_ && p1_ == p2_; }

 private:
  void begin_waiting();

  double p0_ = 0, p1_ = 0, p2_ = 0;
  double elapsed_s_ = 0, interval_s_ = 1;
  struct Waiting {
    double position, interval_s;
  };
  std::optional<Waiting> waiting_;
};

}  // namespace foresight::sim

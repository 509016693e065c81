// How one joint may move from cycle to cycle: within position, velocity, acceleration and jerk.
#pragma once

#include "common/time.hpp"

namespace foresight {

/// Joint units: rad or m. All but the positions > 0.
struct JointLimits {
  double min_position = 0, max_position = 0;
  double velocity = 0;      ///< units/s
  double acceleration = 0;  ///< units/s^2
  double jerk = 0;          ///< units/s^3
};

/// Set-point of a joint. Between two cycles the jerk is constant.
struct JointMotion {
  double position = 0, velocity = 0, acceleration = 0;
};

/// The motion one cycle of `dt` seconds later when the acceleration then is `acceleration`.
JointMotion after(const JointMotion& now, double acceleration, double dt);

/// The next cycle of the fastest stop: at rest (exactly zero) after finitely many, without
/// overshooting zero velocity by more than the initial acceleration forces.
///
///   v ____          a: 0 -> -A at the jerk limit, held, and back to 0 so that v and a
///         \             reach zero together: |a| <= sqrt(2 J |v|)
///          \__.___
///
/// Plans with half of the jerk: what is left is needed to land on zero in whole cycles.
JointMotion brake(const JointMotion& now, const JointLimits& limits, double dt);

/// Where that stop ends.
double stop_position(JointMotion now, const JointLimits& limits, double dt);

/// A cycle, and where the fastest stop from there ends.
struct StoppableMotion {
  JointMotion motion;
  double stop = 0;
};

/// The next cycle towards `target` (position), from which a stop still ends within the position limits:
/// that holds for every later cycle too if it holds now. `speed` in 0 .. 1 scales the velocity limit.
/// Neither throws nor allocates. `target` must be finite.
StoppableMotion approach(const JointMotion& now, double target, const JointLimits& limits, double speed, double dt);

}  // namespace foresight

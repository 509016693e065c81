#include "motion/joint_motion.hpp"

#include <algorithm>
#include <cmath>

namespace foresight {
namespace {

constexpr double kPlanned = 0.5;      // share of the jerk that plans use
constexpr int kMostCycles = 100'000;  // of a stop; only to end the loop with limits that are nonsense

double towards(double from, double to, double step) {
  return from + std::clamp(to - from, -step, step);
}

// The velocity from which `distance` suffices to stop with acceleration a and jerk j.
//   distance(v) = v^2 / 2a + v a / 2j    where v >= a^2 / j, else v^1.5 / sqrt(j)
double velocity_to_stop_within(double distance, double a, double j) {
  const double knee = a * a / j;
  if (distance >= knee * a / j) return -0.5 * knee + std::sqrt(0.25 * knee * knee + 2 * a * distance);
  return std::cbrt(distance * distance * j);
}

}  // namespace

JointMotion after(const JointMotion& now, double acceleration, double dt) {
  // Constant jerk j = (a' - a) / dt: x' = x + v dt + a dt^2 / 2 + j dt^3 / 6.
  return {now.position + dt * (now.velocity + dt * (2 * now.acceleration + acceleration) / 6),
          now.velocity + 0.5 * dt * (now.acceleration + acceleration), acceleration};
}

JointMotion brake(const JointMotion& now, const JointLimits& limits, double dt) {
  const double jerk = kPlanned * limits.jerk, step = jerk * dt;
  const double last = std::min(0.5 * step, limits.acceleration) * dt;  // that one cycle takes away
  if (std::abs(now.velocity) <= last && std::abs(now.acceleration) <= step) return {now.position, 0, 0};
  const double sign = now.velocity < 0 || (now.velocity == 0 && now.acceleration < 0) ? -1 : 1;
  const double v = sign * now.velocity, a = sign * now.acceleration;
  // The largest deceleration x after which v and a can still reach zero together:
  //   x^2 <= 2 J v',  v' = v + (a - x) dt / 2.
  const double room = v + 0.5 * a * dt;
  const double x = room <= 0 ? 0 : 0.5 * (-step + std::sqrt(step * step + 8 * jerk * room));
  return after(now, sign * towards(a, -std::min(x, limits.acceleration), step), dt);
}

double stop_position(JointMotion now, const JointLimits& limits, double dt) {
  for (int i = 0; i < kMostCycles && (now.velocity != 0 || now.acceleration != 0); ++i) now = brake(now, limits, dt);
  return now.position;
}

StoppableMotion approach(const JointMotion& now, double target, const JointLimits& limits, double speed, double dt) {
  const double jerk = kPlanned * limits.jerk, step = jerk * dt;
  const double error = std::clamp(target, limits.min_position, limits.max_position) - now.position;
  // Proportional near the target, where the square roots are too steep for whole cycles.
  const double v =
      std::min({speed * limits.velocity, 0.9 * velocity_to_stop_within(std::abs(error), limits.acceleration, jerk),
                std::abs(error) / (12 * dt)});
  const double missing = std::copysign(v, error) - now.velocity;
  const double a =
      std::min({limits.acceleration, std::sqrt(2 * jerk * std::abs(missing)), std::abs(missing) / (4 * dt)});
  const JointMotion next = after(now, towards(now.acceleration, std::copysign(a, missing), step), dt);
  // Acceleration that is still there carries the velocity on while the jerk takes it away.
  const double peak =
      std::abs(next.velocity + std::copysign(next.acceleration * next.acceleration, next.acceleration) / (2 * jerk));
  const double end = stop_position(next, limits, dt);
  // Accelerated so far that it could no longer stop at the target.
  const bool overshoots = (end - now.position - error) * error > 0 && now.velocity * error > 0;
  const bool stays = end >= limits.min_position && end <= limits.max_position && peak <= limits.velocity &&
                     std::abs(next.velocity) <= limits.velocity;
  if (stays && !overshoots) return {next, end};
  const JointMotion slower = brake(now, limits, dt);
  return {slower, stop_position(slower, limits, dt)};
}

}  // namespace foresight

#include "sim/drives/reference.hpp"

#include <algorithm>
#include <cmath>

namespace foresight::sim {
namespace {

constexpr double kRounding = 1e-9;  // seconds

}  // namespace

Reference change_speed(const Reference& from, double velocity, double rate, double dt) {
  const double next = std::clamp(velocity, from.velocity - rate * dt, from.velocity + rate * dt);
  return {from.position + (from.velocity + next) / 2 * dt, next, (next - from.velocity) / dt};
}

Reference approach(const Reference& from, double target, const ProfileLimits& limits, double dt) {
  const double distance = target - from.position, brake = limits.deceleration;
  if (std::abs(distance) <= brake * dt * dt && std::abs(from.velocity) <= 2 * brake * dt)
    return {target, 0, -from.velocity / dt};
  // The speed after this step from which steady braking ends at the target.
  const double left = std::abs(distance) - std::copysign(from.velocity, distance * from.velocity) * dt / 2;
  const double half = brake * dt / 2;
  const double allowed = left > 0 ? std::sqrt(half * half + 2 * brake * left) - half : 0;
  const double wanted = std::copysign(std::min(limits.velocity, allowed), distance);
  const bool slows = wanted * from.velocity < 0 || std::abs(wanted) < std::abs(from.velocity);
  return change_speed(from, wanted, slows ? brake : limits.acceleration, dt);
}

void CyclicInterpolator::start(double position) {
  p0_ = p1_ = p2_ = position;
  waiting_.reset();
  elapsed_s_ = interval_s_ = 1;
}

void CyclicInterpolator::push(double position, double interval_s) {
  waiting_.reset();
  p0_ = p1_;
  p1_ = p2_;
  p2_ = position;
  elapsed_s_ = 0;
  interval_s_ = interval_s;
}

void CyclicInterpolator::queue(double position, double interval_s) {
  begin_waiting();
  if (elapsed_s_ < interval_s_ - kRounding)
    waiting_ = {position, interval_s};
  else
    push(position, interval_s);
}

// What waits goes on where the interval before it ended; a set-point that waited longer would be one from long ago.
void CyclicInterpolator::begin_waiting() {
  if (!waiting_ || elapsed_s_ < interval_s_ - kRounding) return;
  const Waiting next = *waiting_;
  const double into_next = std::max(0.0, elapsed_s_ - interval_s_);
  push(next.position, next.interval_s);
  elapsed_s_ = into_next;
}

Reference CyclicInterpolator::step(double dt) {
  elapsed_s_ += dt;
  begin_waiting();
  const double s = std::min(1.0, elapsed_s_ / interval_s_), beyond = std::max(0.0, elapsed_s_ - interval_s_);
  const double velocity = ((p1_ - p0_) * (1 - s) + (p2_ - p1_) * s) / interval_s_;
  const double position = p0_ * (1 - s) * (1 - s) / 2 + p1_ * (0.5 + s - s * s) + p2_ * s * s / 2 + velocity * beyond;
  const double acceleration = beyond > 1e-9 ? 0 : (p2_ - 2 * p1_ + p0_) / (interval_s_ * interval_s_);
  return {position, velocity, acceleration};
}

}  // namespace foresight::sim

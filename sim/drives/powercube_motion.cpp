// How the module moves, and what its state word says of that.
#include <algorithm>
#include <cmath>

#include "sim/drives/powercube_node.hpp"
#include "sim/drives/powercube_parameters.hpp"

namespace foresight::sim {

using namespace powercube;

namespace {

constexpr double kStandstill = 1e-3;  // rad/s

}  // namespace

void PowerCubeNode::begin(Activity activity) {
  if (!motor_.shaft().powered) {
    motor_.power(true);
    reference_ = {motor_.shaft().position, 0, 0};
    steps_.start(reference_.position);
  }
  if (activity == Activity::step && activity_ != Activity::step) steps_.start(reference_.position);
  if (activity_ == Activity::current) reference_ = {motor_.shaft().position, motor_.shaft().velocity, 0};
  activity_ = activity;
  ramp_ended_ = false;
}

double PowerCubeNode::cut(double position) {
  beyond_soft_ = false;
  if (config_.motor.limits_off || values_[kMinPos] >= values_[kMaxPos]) return to_shaft(position);
  const double inside = std::clamp(position, values_[kMinPos], values_[kMaxPos]);
  beyond_soft_ = inside != position;
  return to_shaft(inside);
}

void PowerCubeNode::fail(std::uint32_t bits) {
  errors_ |= bits | kError | kHalted;
  if ((bits & kTowError) != 0) reference_ = {motor_.shaft().position, motor_.shaft().velocity, 0};
  if (motor_.shaft().powered)
    begin(Activity::halt);
  else
    activity_ = Activity::idle;
}

void PowerCubeNode::stop_after_silence(RobotTime now) {
  const bool enabled = (static_cast<std::uint32_t>(values_[kConfigWord]) & kWatchdogEnable) != 0;
  if (!enabled || !refreshed_ || now - *refreshed_ <= seconds(config_.watchdog_s)) return;
  refreshed_.reset();
  fail(kCommError);
}

// After the step's time the module goes to the point given and stops there.
Reference PowerCubeNode::next_step(double dt) {
  const double slack = std::min(0.5 * steps_.interval_s(), 0.005);
  if (!steps_.resting() && steps_.elapsed_s() >= steps_.interval_s() + (steps_.interval_s() > 0.05 ? 0 : slack))
    steps_.push(steps_.last(), steps_.interval_s());
  return steps_.step(dt);
}

Reference PowerCubeNode::next_reference(double dt) {
  const double v = values_[kTargetVel], a = values_[kTargetAcc];
  switch (activity_) {
    case Activity::ramp: {
      const Reference next = approach(reference_, target_, {v, a, a}, dt);
      ramp_ended_ = next.position == target_ && next.velocity == 0;
      return next;
    }
    case Activity::step: return next_step(dt);
    case Activity::velocity: {
      // Soft limits stop a velocity motion too, in time.
      const double end = to_shaft(target_ > 0 ? values_[kMaxPos] : values_[kMinPos]);
      if (config_.motor.limits_off || values_[kMinPos] >= values_[kMaxPos] || target_ == 0)
        return change_speed(reference_, target_, a, dt);
      const Reference next = approach(reference_, end, {std::abs(target_), a, a}, dt);
      beyond_soft_ = next.position == end;
      return next;
    }
    case Activity::homing: return approach(reference_, config_.home_position, {values_[kDefHomeVel], a, a}, dt);
    default: return change_speed(reference_, 0, values_[kMaxAcc], dt);
  }
}

void PowerCubeNode::step(RobotTime now, double dt) {
  if (deaf_s_ > 0) deaf_s_ -= dt;
  stop_after_silence(now);
  if (motor_.shaft().powered) {
    reference_ = activity_ == Activity::current ? Reference{motor_.shaft().position, motor_.shaft().velocity, 0}
                                                : next_reference(dt);
    if (activity_ == Activity::current)
      motor_.apply_torque(current_ * kTorquePerAmpere);
    else
      motor_.track(reference_);
  }
  motor_.step(dt);
  if (activity_ == Activity::homing && reference_.position == config_.home_position && reference_.velocity == 0) {
    zero_ = config_.home_position - values_[kHomeOffset];
    homed_ = true;
    activity_ = Activity::idle;
  }
  if (activity_ == Activity::halt && reference_.velocity == 0 && std::abs(motor_.shaft().velocity) < kStandstill) {
    motor_.power(false);
    activity_ = Activity::idle;
  }
  const bool lags = std::abs(motor_.following_error()) > values_[kMaxDelta];
  if (lags && !config_.motor.limits_off && (errors_ & kTowError) == 0) fail(kTowError);
}

std::uint32_t PowerCubeNode::state_word() const {
  const ShaftState& shaft = motor_.shaft();
  const double v = reference_.velocity, a = reference_.acceleration;
  std::uint32_t out = errors_;
  const auto add = [&](bool on, std::uint32_t bit) { out |= on ? bit : 0; };
  add(homed_, kHomeOk);
  add(std::abs(shaft.position - config_.home_position) < 0.01, powercube::kHomeSwitch);
  add(shaft.position <= config_.low_switch, kSwitch1);
  add(shaft.position >= config_.high_switch, kSwitch2);
  add(shaft.brake_closed, kBrakeActive);
  add(motor_.torque_limited(), kCurrentLimit);
  add(std::abs(shaft.velocity) > kStandstill, kMotion);
  const bool ramps = activity_ == Activity::ramp || activity_ == Activity::velocity;
  add(ramps && a * v > 0, kRampAcc);
  add(ramps && a == 0 && v != 0, kRampSteady);
  add(ramps && a * v < 0, kRampDec);
  add(ramp_ended_, kRampEnd);
  add(activity_ == Activity::step && !steps_.resting(), kInProgress);
  add(shaft.hit_stop, kBeyondHard);
  add(beyond_soft_, kBeyondSoft);
  return out;
}

std::uint8_t PowerCubeNode::short_state() const {
  const std::uint32_t state = state_word();
  std::uint8_t out = 0;
  const auto add = [&](bool on, unsigned bit) { out = static_cast<std::uint8_t>(out | (on ? bit : 0)); };
  add((state & (kError | kHalted)) != 0 || (state & kHomeOk) == 0, 0x01);
  add(state & powercube::kHomeSwitch, 0x02);
  add(state & kSwitch1, 0x04);
  add(state & kSwitch2, 0x08);
  add(state & kMotion, 0x10);
  add(state & kRampEnd, 0x20);
  add(state & kInProgress, 0x40);
  return out;
}

}  // namespace foresight::sim

#include "sim/drives/motor.hpp"

#include <algorithm>
#include <cmath>

namespace foresight::sim {
namespace {

constexpr double kCreep = 1e-3;  // rad/s; slower than this dry friction is left alone and stops the shaft

}  // namespace

Motor::Motor(const MotorConfig& config) : config_(config), since_off_s_(config.brake_delay_s) {
  shaft_.position = config.start;
  forget_extremes();
}

void Motor::power(bool on) {
  if (on == shaft_.powered) return;
  shaft_.powered = on;
  shaft_.brake_closed = false;
  since_off_s_ = 0;
  follows_ = on;
  wanted_torque_ = 0;
  reference_ = {shaft_.position, 0, 0};
}

void Motor::track(const Reference& reference) {
  if (!shaft_.powered) return;
  follows_ = true;
  reference_ = reference;
}

void Motor::apply_torque(double torque) {
  if (!shaft_.powered) return;
  follows_ = false;
  wanted_torque_ = torque;
}

void Motor::jam(bool jammed) {
  jammed_ = jammed;
}

double Motor::following_error() const {
  return follows_ ? reference_.position - shaft_.position : 0;
}

bool Motor::following_failed() const {
  return std::abs(following_error()) > config_.following_error_limit;
}

// A velocity loop inside of a position loop, together critically damped. Far away the position loop asks for
// no more speed than can be braked away again. Weight and friction are compensated, as an integrator would do.
double Motor::servo_torque(double dt) {
  const double error = reference_.position - shaft_.position;
  double correction = config_.bandwidth / 2 * error;
  if (!config_.limits_off) {
    const double brakeable = std::sqrt(2 * config_.max_acceleration * std::abs(error));
    correction = std::clamp(correction, -brakeable, brakeable);
  }
  double velocity = reference_.velocity + correction;
  if (!config_.limits_off) velocity = std::clamp(velocity, -config_.max_velocity, config_.max_velocity);
  double acceleration = reference_.acceleration + 2 * config_.bandwidth * (velocity - shaft_.velocity);
  if (!config_.limits_off) {
    acceleration = std::clamp(acceleration, -config_.max_acceleration, config_.max_acceleration);
    const double slowest = std::min((-config_.max_velocity - shaft_.velocity) / dt, config_.max_acceleration);
    const double fastest = std::max((config_.max_velocity - shaft_.velocity) / dt, -config_.max_acceleration);
    acceleration = std::clamp(acceleration, slowest, fastest);
  }
  const bool creeps = reference_.velocity == 0 && std::abs(shaft_.velocity) < kCreep;
  const double moving = creeps ? 0 : reference_.velocity != 0 ? reference_.velocity : shaft_.velocity;
  const double coulomb = moving == 0 ? 0 : std::copysign(0.9 * config_.coulomb, moving);
  return config_.inertia * acceleration + coulomb + config_.viscous * shaft_.velocity - config_.load;
}

void Motor::step(double dt) {
  torque_limited_ = false;
  shaft_.torque = 0;
  if (shaft_.powered) {
    shaft_.torque = follows_ ? servo_torque(dt) : wanted_torque_;
    if (!config_.limits_off && std::abs(shaft_.torque) > config_.torque_limit) {
      shaft_.torque = std::copysign(config_.torque_limit, shaft_.torque);
      torque_limited_ = true;
    }
  } else {
    since_off_s_ += dt;
    shaft_.brake_closed = since_off_s_ >= config_.brake_delay_s;
  }
  const double before = shaft_.velocity;
  double velocity = before + (shaft_.torque + config_.load) / config_.inertia * dt;
  // Friction takes speed away, never turns it round: within one step it stops the shaft and holds it.
  const double friction =
      config_.coulomb + config_.viscous * std::abs(before) + (shaft_.brake_closed ? config_.brake_torque : 0);
  const double lost = friction / config_.inertia * dt;
  velocity = jammed_ || std::abs(velocity) <= lost ? 0 : velocity - std::copysign(lost, velocity);
  shaft_.position += (before + velocity) / 2 * dt;
  shaft_.velocity = velocity;
  if (!config_.limits_off && (shaft_.position < config_.min_stop || shaft_.position > config_.max_stop)) {
    shaft_.position = std::clamp(shaft_.position, config_.min_stop, config_.max_stop);
    shaft_.velocity = 0;
    shaft_.hit_stop = true;
  }
  record((shaft_.velocity - before) / dt);
}

void Motor::record(double acceleration) {
  shaft_.acceleration = acceleration;
  shaft_.most_positive = std::max(shaft_.most_positive, shaft_.position);
  shaft_.most_negative = std::min(shaft_.most_negative, shaft_.position);
  shaft_.largest_position = std::max(shaft_.largest_position, std::abs(shaft_.position));
  shaft_.largest_velocity = std::max(shaft_.largest_velocity, std::abs(shaft_.velocity));
  shaft_.largest_acceleration = std::max(shaft_.largest_acceleration, std::abs(acceleration));
}

void Motor::forget_extremes() {
  shaft_.most_positive = shaft_.most_negative = shaft_.position;
  shaft_.largest_position = std::abs(shaft_.position);
  shaft_.largest_velocity = std::abs(shaft_.velocity);
  shaft_.largest_acceleration = std::abs(shaft_.acceleration);
  shaft_.hit_stop = false;
}

}  // namespace foresight::sim

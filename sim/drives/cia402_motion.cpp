#include "sim/drives/cia402_motion.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace foresight::sim {

void Cia402Motion::hold(double position) {
  reference_ = {position, 0, 0};
  target_.reset();
  next_.reset();
  cyclic_.start(wanted_ == Mode::cyclic_velocity ? 0 : position);
  fresh_ = monitored_ = holding_ = missed_event_ = limited_ = false;
  missed_ = 0;
  search_.reset();
  home_.reset();
  homing_failed_ = false;
  mode_ = wanted_;
}

double Cia402Motion::limited_position(double position) {
  limited_ = false;
  if (settings.min_position >= settings.max_position) return position;
  const double inside = std::clamp(position, settings.min_position, settings.max_position);
  limited_ = inside != position;
  return inside;
}

bool Cia402Motion::new_target(double position, bool at_once) {
  if (at_once || !target_) {
    target_ = limited_position(position);
    next_.reset();
    return true;
  }
  if (next_) return false;
  next_ = position;
  return true;
}

bool Cia402Motion::target_reached() const {
  return mode_ == Mode::profile_position ? !target_ && !next_ : at_rest();
}

void Cia402Motion::set_point(double value, bool cyclic) {
  set_point_ = value;
  fresh_ = true;
  monitored_ = monitored_ || cyclic;
}

void Cia402Motion::synchronised() {
  since_sync_s_ = 0;
  if (mode_ != Mode::interpolated && mode_ != Mode::cyclic_position && mode_ != Mode::cyclic_velocity) return;
  begin_interval();
}

// A set-point that is missing is guessed from the two before it; too many are an event.
void Cia402Motion::begin_interval() {
  if (holding_ && fresh_ && at_rest()) {
    holding_ = false;
    cyclic_.start(reference_.position);
  }
  const bool velocity = mode_ == Mode::cyclic_velocity;
  if (fresh_) {
    missed_ = 0;
    cyclic_.push(velocity ? set_point_ : limited_position(set_point_), settings.interval_s);
  } else if (!monitored_ || velocity) {
    missed_ += monitored_ ? 1 : 0;
    cyclic_.push(cyclic_.last(), settings.interval_s);
  } else {
    ++missed_;
    cyclic_.push(limited_position(cyclic_.extrapolated()), settings.interval_s);
  }
  fresh_ = false;
  if (missed_ <= settings.missed_set_points || holding_) return;
  monitored_ = false;
  missed_ = 0;
  holding_ = true;
  missed_event_ = !settings.hold_when_missed;
}

bool Cia402Motion::take_missed() {
  return std::exchange(missed_event_, false);
}

// An interval begins with SYNC, else with a set-point's arrival; half an interval later it is overdue.
void Cia402Motion::step_cyclic(double dt) {
  const double elapsed = cyclic_.elapsed_s(), interval = cyclic_.interval_s();
  const bool synced = since_sync_s_ < 3 * settings.interval_s;
  if ((!synced && fresh_ && elapsed > interval - dt / 2) || elapsed >= 1.5 * interval) begin_interval();
  if (holding_)
    reference_ = change_speed(reference_, 0, settings.quick_deceleration, dt);
  else
    reference_ = cyclic_.step(dt);
}

// Here the interpolator runs over velocities, and the reference is their integral.
void Cia402Motion::step_velocity(double dt) {
  const Reference before = reference_;
  step_cyclic(dt);
  if (holding_) return;
  double velocity = reference_.position;
  limited_ = false;
  if (settings.min_position < settings.max_position && velocity != 0) {
    const double end = velocity > 0 ? settings.max_position : settings.min_position;
    const double room = std::max(0.0, (end - before.position) * (velocity > 0 ? 1 : -1));
    const double allowed = std::sqrt(2 * settings.quick_deceleration * room);
    limited_ = std::abs(velocity) > allowed;
    if (limited_) velocity = std::copysign(allowed, velocity);
  }
  reference_ = {before.position + (before.velocity + velocity) / 2 * dt, velocity, (velocity - before.velocity) / dt};
}

bool Cia402Motion::start_homing() {
  home_.reset();
  search_.reset();
  homing_failed_ = false;
  const int number = settings.homing_method;
  const auto method = homing_method(number);
  if (method) search_.emplace(*method, settings.index_distance, settings.index_at);
  if (number == 35 || number == 37) home_ = reference_.position;
  return method || home_;
}

std::optional<double> Cia402Motion::take_home() {
  return std::exchange(home_, std::nullopt);
}

bool Cia402Motion::take_homing_failure() {
  return std::exchange(homing_failed_, false);
}

void Cia402Motion::step_homing(double dt, double shaft, unsigned switches) {
  const int speed = search_ ? static_cast<int>(search_->step(shaft, switches)) : 0;
  const double velocity = std::copysign(std::abs(speed) == 2   ? settings.homing_fast
                                        : std::abs(speed) == 1 ? settings.homing_slow
                                                               : 0,
                                        speed);
  reference_ = change_speed(reference_, velocity, settings.homing_acceleration, dt);
  if (!search_ || speed != 0 || !at_rest()) return;
  home_ = search_->home();
  homing_failed_ = search_->failed();
  search_.reset();
}

void Cia402Motion::step_mode(double dt, double shaft, unsigned switches) {
  switch (mode_) {
    case Mode::profile_position:
      if (target_)
        reference_ = approach(reference_, *target_, settings.profile, dt);
      else
        reference_ = change_speed(reference_, 0, settings.profile.deceleration, dt);
      if (!target_ || reference_.position != *target_ || !at_rest()) return;
      target_.reset();
      if (next_) target_ = limited_position(*next_);
      next_.reset();
      return;
    case Mode::homing: return step_homing(dt, shaft, switches);
    case Mode::interpolated:
    case Mode::cyclic_position: return step_cyclic(dt);
    case Mode::cyclic_velocity: return step_velocity(dt);
    case Mode::none: reference_ = change_speed(reference_, 0, settings.profile.deceleration, dt); return;
  }
}

Reference Cia402Motion::step(double dt, Braking braking, bool halted, double shaft, unsigned switches) {
  since_sync_s_ += dt;
  const bool changes = wanted_ != mode_;
  if (braking == Braking::none && !changes) {
    step_mode(dt, shaft, switches);
    return reference_;
  }
  const double rate = braking == Braking::quick ? settings.quick_deceleration : settings.profile.deceleration;
  reference_ = change_speed(reference_, 0, rate, dt);
  const Reference slowed = reference_;
  if (!halted || changes) {
    target_.reset();
    next_.reset();
    search_.reset();
  }
  if (changes && at_rest()) hold(slowed.position);
  fresh_ = monitored_ = holding_ = false;
  cyclic_.start(mode_ == Mode::cyclic_velocity ? slowed.velocity : slowed.position);
  reference_ = slowed;
  return reference_;
}

}  // namespace foresight::sim

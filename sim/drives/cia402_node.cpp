#include "sim/drives/cia402_node.hpp"

#include <algorithm>
#include <cmath>

#include "sim/drives/dcf_reader.hpp"
#include "sim/drives/generic_402.hpp"

namespace foresight::sim {
namespace {

constexpr std::uint32_t kErrorCode = object_key(0x603F), kControlword = object_key(0x6040),
                        kStatusword = object_key(0x6041), kMode = object_key(0x6060), kModeDisplay = object_key(0x6061),
                        kPositionDemand = object_key(0x6062), kPosition = object_key(0x6064),
                        kVelocity = object_key(0x606C), kTorque = object_key(0x6077),
                        kTargetPosition = object_key(0x607A), kInterpolated = object_key(0x60C1, 1),
                        kTargetVelocity = object_key(0x60FF), kFollowingError = object_key(0x60F4),
                        kInputs = object_key(0x60FD), kSupportedModes = object_key(0x6502);
constexpr unsigned kHomingMethods = 0x60E3;
constexpr std::uint16_t kHalt = 0x100, kNewSetPoint = 0x10;
constexpr double kRest = 1e-3;  // rad/s, when a brake may close

ObjectDictionary dictionary_of(const NodeConfig& config) {
  if (!config.dictionary.empty()) return read_dcf(config.dictionary, config.node);
  ObjectDictionary out = generic_402(config.node);
  const std::vector<int>& methods = config.homing_methods.empty() ? served_homing_methods() : config.homing_methods;
  out.define(object_key(kHomingMethods), DataType::uint8, Access::ro, static_cast<std::int64_t>(methods.size()));
  for (std::size_t i = 0; i < methods.size(); ++i)
    out.define(object_key(kHomingMethods, static_cast<unsigned>(i) + 1), DataType::int16, Access::ro, methods[i]);
  return out;
}

std::int64_t whole(double value) {
  return static_cast<std::int64_t>(std::llround(std::clamp(value, -2147483648.0, 2147483647.0)));
}

}  // namespace

Cia402Node::Cia402Node(const NodeConfig& config, Send send)
    : CanopenNode(config, dictionary_of(config), std::move(send)) {
  restarted();
}

std::int64_t Cia402Node::to_counts(double shaft) const {
  return whole((shaft - zero_) * config_.counts_per_unit);
}

double Cia402Node::scaled(unsigned index, unsigned sub, double otherwise) const {
  const auto value = static_cast<double>(objects_.integer(object_key(index, sub)));
  return value > 0 ? value / config_.counts_per_unit : otherwise;
}

// What objects leave at 0 or do not hold comes from the configuration.
void Cia402Node::load_settings() {
  const MotorConfig& motor = config_.motor;
  MotionSettings& settings = motion_.settings;
  settings.profile.velocity = scaled(0x6081, 0, motor.max_velocity / 2);
  settings.profile.acceleration = scaled(0x6083, 0, motor.max_acceleration / 2);
  settings.profile.deceleration = scaled(0x6084, 0, settings.profile.acceleration);
  settings.quick_deceleration = scaled(0x6085, 0, motor.max_acceleration * 0.8);
  if (!motor.limits_off) {
    settings.profile.velocity = std::min(settings.profile.velocity, scaled(0x607F, 0, motor.max_velocity));
    settings.profile.acceleration = std::min(settings.profile.acceleration, scaled(0x60C5, 0, motor.max_acceleration));
    settings.profile.deceleration = std::min(settings.profile.deceleration, scaled(0x60C6, 0, motor.max_acceleration));
  }
  const std::int64_t low = objects_.integer(object_key(0x607D, 1)), high = objects_.integer(object_key(0x607D, 2));
  const bool own = low >= high;
  settings.min_position = own ? config_.min_position : to_shaft(static_cast<double>(low));
  settings.max_position = own ? config_.max_position : to_shaft(static_cast<double>(high));
  if (motor.limits_off) settings.min_position = settings.max_position = 0;
  const double period = static_cast<double>(objects_.integer(object_key(0x60C2, 1), 10)) *
                        std::pow(10.0, static_cast<double>(objects_.integer(object_key(0x60C2, 2), -3)));
  settings.interval_s = std::clamp(period, 0.001, 1.0);
  settings.missed_set_points = config_.missed_set_points;
  settings.hold_when_missed = config_.hold_when_missed;
  settings.homing_method = static_cast<int>(objects_.integer(object_key(0x6098), 37));
  settings.homing_fast = scaled(0x6099, 1, motor.max_velocity / 20);
  settings.homing_slow = scaled(0x6099, 2, motor.max_velocity / 100);
  settings.index_distance = config_.index_distance;
  settings.index_at = config_.index_at;
  settings.homing_acceleration = scaled(0x609A, 0, motor.max_acceleration / 10);
  StopOptions& options = states_.options;
  options.quick_stop = static_cast<int>(objects_.integer(object_key(0x605A), 2));
  options.shutdown = static_cast<int>(objects_.integer(object_key(0x605B), 0));
  options.disable = static_cast<int>(objects_.integer(object_key(0x605C), 1));
  options.fault = static_cast<int>(objects_.integer(object_key(0x605E), 2));
}

void Cia402Node::restarted() {
  motor_.power(false);
  zero_ = config_.homed ? 0 : motor_.shaft().position;
  controlword_ = error_code_ = 0;
  acknowledge_ = homing_failed_ = following_error_ = false;
  homed_ = config_.homed;
  states_ = {};
  motion_ = {};
  load_settings();
  motion_.hold(motor_.shaft().position);
}

void Cia402Node::power(bool on) {
  if (on == motor_.shaft().powered) return;
  motor_.power(on);
  if (on) motion_.hold(motor_.shaft().position);
}

bool Cia402Node::serves_homing(std::int64_t method) const {
  const auto& all = served_homing_methods();
  if (std::find(all.begin(), all.end(), method) == all.end()) return false;
  const std::int64_t listed = objects_.integer(object_key(kHomingMethods));
  for (std::int64_t sub = 1; sub <= listed; ++sub)
    if (objects_.integer(object_key(kHomingMethods, static_cast<unsigned>(sub))) == method) return true;
  return listed == 0;
}

SdoAbort Cia402Node::check(std::uint32_t key, std::int64_t value) {
  if (key == object_key(0x6098)) return serves_homing(value) ? SdoAbort::none : SdoAbort::value_range;
  if (key != kMode) return SdoAbort::none;
  constexpr std::array served{0, 1, 6, 7, 8, 9};
  if (std::find(served.begin(), served.end(), value) == served.end()) return SdoAbort::value_range;
  const std::int64_t supported = objects_.integer(kSupportedModes, 0x1E1);
  return value == 0 || (supported >> (value - 1) & 1) != 0 ? SdoAbort::none : SdoAbort::value_range;
}

void Cia402Node::written(std::uint32_t key, bool by_pdo) {
  if (key == kControlword) return control();
  if (key == kMode) motion_.want_mode(static_cast<Mode>(objects_.integer(kMode)));
  const bool enabled = states_.state() == PowerState::operation_enabled;
  const Mode mode = motion_.mode();
  const auto value = static_cast<double>(objects_.integer(key));
  if (enabled && ((key == kTargetPosition && mode == Mode::cyclic_position) ||
                  (key == kInterpolated && mode == Mode::interpolated && (controlword_ & kNewSetPoint) != 0)))
    motion_.set_point(to_shaft(value), by_pdo);
  if (enabled && key == kTargetVelocity && mode == Mode::cyclic_velocity)
    motion_.set_point(value / config_.counts_per_unit, by_pdo);
  load_settings();
}

void Cia402Node::control() {
  const std::uint16_t before = controlword_;
  controlword_ = static_cast<std::uint16_t>(objects_.integer(kControlword));
  const bool was_fault = states_.state() == PowerState::fault;
  states_.control(controlword_);
  power(states_.powered());
  if (was_fault && states_.state() != PowerState::fault) {
    error_code_ = 0;
    following_error_ = false;
    clear_errors();
  }
  if (states_.state() != PowerState::operation_enabled)
    acknowledge_ = false;
  else if (motion_.mode() == Mode::profile_position)
    control_profile(controlword_);
  else if (motion_.mode() == Mode::homing && ((before ^ controlword_) & kNewSetPoint) != 0)
    control_homing(controlword_);
}

// CiA 402-2, 10.3: bit 4 offers a target, bit 12 takes it and stays up until bit 4 is down and there is room again.
void Cia402Node::control_profile(std::uint16_t controlword) {
  const bool offered = controlword & kNewSetPoint;
  if (offered && !acknowledge_) {
    const auto counts = static_cast<double>(objects_.integer(kTargetPosition));
    const bool relative = controlword & 0x40;
    const double from = motion_.reference().position;
    const double target = relative ? from + counts / config_.counts_per_unit : to_shaft(counts);
    acknowledge_ = motion_.new_target(target, (controlword & 0x20) != 0);
  } else if (!offered && !motion_.target_waits()) {
    acknowledge_ = false;
  }
}

void Cia402Node::control_homing(std::uint16_t controlword) {
  if ((controlword & kNewSetPoint) == 0) return motion_.cancel_homing();
  homed_ = false;
  homing_failed_ = !serves_homing(motion_.settings.homing_method) || !motion_.start_homing();
}

void Cia402Node::synchronised(RobotTime) {
  if (states_.state() == PowerState::operation_enabled) motion_.synchronised();
}

void Cia402Node::connection_lost() {
  const int option = static_cast<int>(objects_.integer(object_key(0x6007), 1));
  if (option == 1 && states_.powered()) error_code_ = 0x8130;
  if (option != 1 || states_.powered()) states_.connection_lost(option);
}

void Cia402Node::fail(std::uint16_t code, std::uint8_t bits) {
  if (states_.state() == PowerState::fault || states_.state() == PowerState::fault_reaction_active) return;
  error_code_ = code;
  emergency(code, bits);
  states_.fault();
  if (code == 0x8611) motion_.follow_shaft(motor_.shaft());
}

void Cia402Node::inject(DriveFault fault, double value) {
  switch (fault) {
    case DriveFault::recover:
      frozen_ = garbage_ = false;
      noise_ = 0;
      motor_.jam(false);
      objects_.set(object_key(0x1018, 2), config_.product);
      objects_.set(object_key(0x1018, 4), config_.serial);
      return;
    case DriveFault::overcurrent:
      // A short circuit leaves no current to brake with.
      fail(0x2310, 0x02);
      while (states_.state() == PowerState::fault_reaction_active) states_.at_rest();
      power(false);
      return;
    case DriveFault::tow_error: following_error_ = true; return fail(0x8611, 0x20);
    case DriveFault::emergency: return emergency(static_cast<std::uint16_t>(value), 0);
    case DriveFault::reset: return restart(now());
    case DriveFault::frozen:
      refresh();
      frozen_ = true;
      return;
    case DriveFault::garbage: garbage_ = true; return;
    case DriveFault::wrong_identity:
      objects_.set(object_key(0x1018, 2), config_.product ^ 0x5555);
      objects_.set(object_key(0x1018, 4), config_.serial ^ 0x5555);
      return;
    case DriveFault::jam: motor_.jam(true); return;
    case DriveFault::noisy: noise_ = value; return;
    case DriveFault::silent:
    case DriveFault::slow:
    case DriveFault::unplugged:
    case DriveFault::no_power: return;  // of the wires: the rack does it
  }
}

unsigned Cia402Node::switches() const {
  const double at = motor_.shaft().position;
  const bool home = at >= config_.home_switch_low && at <= config_.home_switch_high;
  return (at <= config_.low_switch ? kNegativeLimit : 0) | (at >= config_.high_switch ? kPositiveLimit : 0) |
         (home ? kHomeSwitch : 0);
}

void Cia402Node::take_events() {
  if (motion_.take_missed()) fail(0x8250, 0x10);
  if (const auto home = motion_.take_home()) {
    zero_ = *home - static_cast<double>(objects_.integer(object_key(0x607C))) / config_.counts_per_unit;
    homed_ = true;
    load_settings();
  }
  homing_failed_ = motion_.take_homing_failure() || homing_failed_;
  if (states_.powered() && motor_.following_failed() && !config_.motor.limits_off) {
    following_error_ = true;
    fail(0x8611, 0x20);
  }
}

void Cia402Node::run(RobotTime, double dt) {
  if (alive() && states_.state() == PowerState::not_ready) states_.power_on();
  power(states_.powered());
  if (states_.powered()) {
    const bool halted = states_.braking() == Braking::none && (controlword_ & kHalt) != 0;
    const Braking braking = !halted                                        ? states_.braking()
                            : objects_.integer(object_key(0x605D), 1) == 1 ? Braking::slow_down
                                                                           : Braking::quick;
    motor_.track(motion_.step(dt, braking, halted, motor_.shaft().position, switches()));
    if (motion_.at_rest() && std::abs(motor_.shaft().velocity) < kRest) states_.at_rest();
  } else {
    motion_.hold(motor_.shaft().position);  // a new mode counts at once
  }
  motor_.step(dt);
  take_events();
  power(states_.powered());
  if (acknowledge_ && (controlword_ & kNewSetPoint) == 0 && !motion_.target_waits()) acknowledge_ = false;
}

std::uint16_t Cia402Node::mode_bits() const {
  if (states_.state() != PowerState::operation_enabled) return 0;
  const std::uint16_t bit12 = 0x1000, bit13 = following_error_ ? 0x2000 : 0;
  switch (motion_.mode()) {
    case Mode::profile_position: return bit13 | (acknowledge_ ? bit12 : 0);
    case Mode::homing: return (homing_failed_ ? 0x2000 : 0) | (homed_ && !motion_.homing_active() ? bit12 : 0);
    case Mode::interpolated: return (controlword_ & kNewSetPoint) != 0 ? bit12 : 0;
    case Mode::cyclic_position:
    case Mode::cyclic_velocity: return bit12 | bit13;
    case Mode::none: return 0;
  }
  return 0;
}

std::uint16_t Cia402Node::statusword() const {
  std::uint16_t out = states_.status_bits() | 0x0200 | mode_bits();  // 9: listens to the bus
  const bool halted = (controlword_ & kHalt) != 0;
  if (halted ? motion_.at_rest() : motion_.target_reached()) out |= 0x0400;
  if (motion_.limited() || (switches() & (kNegativeLimit | kPositiveLimit)) != 0) out |= 0x0800;
  return out;
}

void Cia402Node::refresh() {
  objects_.set(kStatusword, statusword());
  objects_.set(kErrorCode, error_code_);
  objects_.set(kModeDisplay, static_cast<std::int64_t>(motion_.mode()));
  objects_.set(kInputs, switches());
  objects_.set(kPositionDemand, to_counts(motion_.reference().position));
  objects_.set(kFollowingError, whole(motor_.following_error() * config_.counts_per_unit));
  objects_.set(kTorque, std::clamp<std::int64_t>(whole(1000 * motor_.shaft().torque / config_.motor.torque_limit),
                                                 -32768, 32767));
  if (frozen_) return;
  if (garbage_) {
    objects_.set(kPosition, whole(arbitrary() * 2147483647));
    objects_.set(kVelocity, whole(arbitrary() * 2147483647));
    return;
  }
  objects_.set(kPosition, to_counts(encoder()));
  objects_.set(kVelocity, whole(motor_.shaft().velocity * config_.counts_per_unit));
}

}  // namespace foresight::sim

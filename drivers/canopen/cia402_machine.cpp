#include "drivers/canopen/cia402_machine.hpp"

namespace foresight::canopen {
namespace {

using S = Cia402State;
using namespace std::chrono_literals;

constexpr Duration kEnableTime = 3s;  // brakes and main contactors take up to a second
constexpr Duration kResetTime = 2s;
// From a control word to the status word that knows of it: sent before SYNC 1, applied there, sampled at
// SYNC 2, read before the step that follows it.
constexpr int kAnswerCycles = 4;

constexpr bool is_fault(S state) {
  return state == S::fault || state == S::fault_reaction_active;
}

}  // namespace

void Cia402Machine::request(DriveRequest what) noexcept {
  if (what != DriveRequest::none && pending_ != DriveRequest::quick_stop) pending_ = what;
}

void Cia402Machine::set_goal(Goal goal) noexcept {
  goal_ = goal;
  cycles_ = 0;
  was_operational_ = false;
  follows_ = false;
  since_ = now_;
  wanted_mode_ = goal == Goal::home ? OperationMode::homing : mode_;
}

void Cia402Machine::restart() noexcept {
  set_goal(Goal::off);
  pending_ = DriveRequest::none;
  trouble_ = "";
}

std::uint16_t Cia402Machine::step(const Input& in, RobotTime now) noexcept {
  now_ = now;
  observe(in);
  check_lost(in);
  take_request(in);
  const std::uint16_t word = control(in);
  follows_ =
      goal_ == Goal::enable && known_ && state_ == S::operation_enabled && in.mode_shown == static_cast<int>(mode_);
  return word;
}

void Cia402Machine::observe(const Input& in) noexcept {
  const auto seen = state_of(in.status);
  known_ = seen.has_value();
  if (!seen || *seen == state_) return;
  transition_ = transition_between(state_, *seen).value_or(-1);
  state_ = *seen;
}

void Cia402Machine::check_lost(const Input& in) noexcept {
  const bool active = goal_ == Goal::enable || goal_ == Goal::home;
  if (active && (!in.may_enable || in.error_told || !known_)) return set_goal(Goal::quick_stop);
  if (is_fault(state_) && goal_ != Goal::reset) return set_goal(Goal::off);
  if (!active) return;
  if (was_operational_ && state_ != S::operation_enabled) {
    trouble_ = "the drive left operation by itself";
    return set_goal(state_ == S::quick_stop_active ? Goal::quick_stop : Goal::off);
  }
  if (follows_ && in.mode_shown != static_cast<int>(mode_)) {
    trouble_ = "the drive left its mode of operation by itself";
    return set_goal(Goal::quick_stop);
  }
  if (!follows_ && goal_ == Goal::enable && now_ - since_ > kEnableTime) {
    trouble_ = "the drive did not enable in time";
    return set_goal(Goal::off);
  }
  was_operational_ = was_operational_ || state_ == S::operation_enabled;
}

void Cia402Machine::take_request(const Input& in) noexcept {
  const DriveRequest what = pending_;
  pending_ = DriveRequest::none;
  if (what == DriveRequest::none) return;
  const bool faulty = is_fault(state_) || in.error_told;
  if (what == DriveRequest::enable) {
    if (goal_ == Goal::enable || goal_ == Goal::home) return;
    if (faulty || !in.may_enable || !known_ || state_ == S::not_ready) return;
    set_goal(Goal::enable);
  } else if (what == DriveRequest::disable) {
    set_goal(Goal::off);
  } else if (what == DriveRequest::quick_stop) {
    set_goal(Goal::quick_stop);
  } else if (what == DriveRequest::home) {
    if (!can_home_ || !follows_) return;
    set_goal(Goal::home);
    homed_ = false;
  } else if (what == DriveRequest::reset_fault) {
    if (!faulty || goal_ == Goal::reset) return;
    set_goal(Goal::reset);
  }
  trouble_ = "";
}

std::uint16_t Cia402Machine::control(const Input& in) noexcept {
  switch (goal_) {
    case Goal::enable: {
      const auto command = next_command(state_, S::operation_enabled);
      return control_word(state_ == S::operation_enabled ? Cia402Command::enable_operation
                                                         : command.value_or(Cia402Command::disable_voltage));
    }
    case Goal::home: return home(in);
    case Goal::quick_stop: return control_word(Cia402Command::quick_stop);
    case Goal::reset:
      if (state_ == S::fault) return reset_edge();
      if (state_ == S::fault_reaction_active) return 0;
      if (!in.error_told) set_goal(Goal::off);
      return 0;
    case Goal::off: break;
  }
  // Out of motion by the drive's own ramp (605Ch) before the power goes.
  return control_word(state_ == S::operation_enabled ? Cia402Command::disable_operation
                                                     : Cia402Command::disable_voltage);
}

std::uint16_t Cia402Machine::reset_edge() noexcept {
  // Some cycles with bit 7 low, then high: the edge is seen even where a frame is lost.
  if (++cycles_ > 4 * kAnswerCycles) {
    trouble_ = "the fault cannot be reset, its cause remains";
    set_goal(Goal::off);
    return 0;
  }
  return cycles_ <= 2 ? 0 : control_word(Cia402Command::fault_reset);
}

std::uint16_t Cia402Machine::home(const Input& in) noexcept {
  const std::uint16_t word = control_word(Cia402Command::enable_operation);
  if (in.mode_shown != static_cast<int>(OperationMode::homing)) {
    cycles_ = 0;
    return word;
  }
  ++cycles_;
  // CiA 402-2, table 100. Bits 12 and 13 mean something else in other modes, and may still tell of an
  // earlier homing until the drive has seen the start bit.
  if (cycles_ > kAnswerCycles) {
    const bool attained = in.status & kStatusBit12, reached = in.status & kStatusTargetReached;
    if (in.status & kStatusBit13) {
      trouble_ = "homing failed, the drive reports a homing error";
      set_goal(Goal::quick_stop);
      return control_word(Cia402Command::quick_stop);
    }
    if (attained && reached) {
      homed_ = true;
      set_goal(Goal::enable);
      was_operational_ = true;
      return word;
    }
  }
  return cycles_ < 2 ? word : word | kControlBit4;
}

DriveState Cia402Machine::state() const noexcept {
  if (is_fault(state_) || goal_ == Goal::reset) return DriveState::fault;
  if (state_ == S::quick_stop_active) return DriveState::stopping;
  const bool operational = state_ == S::operation_enabled;
  switch (goal_) {
    case Goal::enable: return follows_ ? DriveState::enabled : DriveState::enabling;
    case Goal::home: return DriveState::homing;
    case Goal::quick_stop:
    case Goal::off: return operational ? DriveState::stopping : DriveState::disabled;
    case Goal::reset: break;
  }
  return DriveState::fault;
}

}  // namespace foresight::canopen

#include "sim/drives/cia402_states.hpp"

namespace foresight::sim {

using enum PowerState;

void PowerStates::power_on() {
  state_ = switch_on_disabled;
  braking_ = Braking::none;
  last_ = 0;
}

void PowerStates::disable_voltage() {
  if (state_ == not_ready || state_ == fault_reaction_active || state_ == PowerState::fault) return;
  state_ = switch_on_disabled;
  braking_ = Braking::none;
}

void PowerStates::quick_stop() {
  if (state_ == ready_to_switch_on || state_ == switched_on) return disable_voltage();
  if (state_ != operation_enabled) return;
  if (options.quick_stop == 0) return disable_voltage();
  state_ = quick_stop_active;
  after_braking_ = options.quick_stop >= 5 ? quick_stop_active : switch_on_disabled;
  braking_ = options.quick_stop == 1 || options.quick_stop == 5 ? Braking::slow_down : Braking::quick;
}

void PowerStates::leave_enabled(PowerState to, bool slow_down) {
  if (slow_down) {
    braking_ = Braking::slow_down;
    after_braking_ = to;
  } else {
    state_ = to;
    braking_ = Braking::none;
  }
}

void PowerStates::control(std::uint16_t controlword) {
  const bool edge = (controlword & 0x80) != 0 && (last_ & 0x80) == 0;
  last_ = controlword;
  if (state_ == PowerState::fault) {
    if (edge) state_ = switch_on_disabled;
    return;
  }
  if (state_ == not_ready || state_ == fault_reaction_active) return;
  if ((controlword & 0x02) == 0) return disable_voltage();
  if ((controlword & 0x04) == 0) return quick_stop();
  const bool switch_on = controlword & 0x01, enable = switch_on && (controlword & 0x08) != 0;
  switch (state_) {
    case switch_on_disabled:
      if (!switch_on) state_ = ready_to_switch_on;
      return;
    case ready_to_switch_on:
      if (enable)
        state_ = operation_enabled;  // transitions 3 and 4 in one
      else if (switch_on)
        state_ = switched_on;
      return;
    case switched_on:
      if (enable)
        state_ = operation_enabled;
      else if (!switch_on)
        state_ = ready_to_switch_on;
      return;
    case operation_enabled:
      if (enable)
        braking_ = Braking::none;
      else
        leave_enabled(switch_on ? switched_on : ready_to_switch_on,
                      (switch_on ? options.disable : options.shutdown) == 1);
      return;
    case quick_stop_active:
      if (!enable || options.quick_stop < 5) return;
      state_ = operation_enabled;
      braking_ = Braking::none;
      return;
    default: return;
  }
}

void PowerStates::fault() {
  if (state_ == PowerState::fault || state_ == fault_reaction_active) return;
  const bool was_powered = powered();
  state_ = was_powered && options.fault != 0 ? fault_reaction_active : PowerState::fault;
  braking_ = state_ == PowerState::fault ? Braking::none : options.fault == 1 ? Braking::slow_down : Braking::quick;
}

void PowerStates::connection_lost(int option) {
  if (option == 1) fault();
  if (option == 2) disable_voltage();
  if (option == 3) quick_stop();
}

void PowerStates::at_rest() {
  if (state_ == fault_reaction_active)
    state_ = PowerState::fault;
  else if (braking_ != Braking::none && state_ != PowerState::fault)
    state_ = after_braking_;
  else
    return;
  if (state_ != quick_stop_active) braking_ = Braking::none;
}

bool PowerStates::powered() const {
  return state_ == operation_enabled || state_ == quick_stop_active || state_ == fault_reaction_active;
}

std::uint16_t PowerStates::status_bits() const {
  const std::uint16_t voltage = powered() ? 0x10 : 0;
  switch (state_) {
    case not_ready: return 0x00;
    case switch_on_disabled: return 0x40;
    case ready_to_switch_on: return 0x21;
    case switched_on: return 0x23;
    case operation_enabled: return 0x27 | voltage;
    case quick_stop_active: return 0x07 | voltage;
    case fault_reaction_active: return 0x0F | voltage;
    case PowerState::fault: return 0x08;
  }
  return 0;
}

}  // namespace foresight::sim

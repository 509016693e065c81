#include "drivers/canopen/cia402.hpp"

#include <algorithm>

namespace foresight::canopen {
namespace {

using S = Cia402State;
using C = Cia402Command;

constexpr Transition kTransitions[] = {
    {1, S::not_ready, S::switch_on_disabled, std::nullopt},
    {2, S::switch_on_disabled, S::ready_to_switch_on, C::shutdown},
    {3, S::ready_to_switch_on, S::switched_on, C::switch_on},
    {4, S::switched_on, S::operation_enabled, C::enable_operation},
    {5, S::operation_enabled, S::switched_on, C::disable_operation},
    {6, S::switched_on, S::ready_to_switch_on, C::shutdown},
    {7, S::ready_to_switch_on, S::switch_on_disabled, C::disable_voltage},
    {7, S::ready_to_switch_on, S::switch_on_disabled, C::quick_stop},
    {8, S::operation_enabled, S::ready_to_switch_on, C::shutdown},
    {9, S::operation_enabled, S::switch_on_disabled, C::disable_voltage},
    {10, S::switched_on, S::switch_on_disabled, C::disable_voltage},
    {10, S::switched_on, S::switch_on_disabled, C::quick_stop},
    {11, S::operation_enabled, S::quick_stop_active, C::quick_stop},
    {12, S::quick_stop_active, S::switch_on_disabled, C::disable_voltage},
    {14, S::fault_reaction_active, S::fault, std::nullopt},
    {15, S::fault, S::switch_on_disabled, C::fault_reset},
    {16, S::quick_stop_active, S::operation_enabled, C::enable_operation},
};

// The state through which a goal that is no neighbour is reached.
S next_state(S from, S goal) {
  if (from == S::switch_on_disabled) return S::ready_to_switch_on;
  if (from == S::ready_to_switch_on) return goal == S::switch_on_disabled ? goal : S::switched_on;
  if (from == S::quick_stop_active) return goal == S::operation_enabled ? goal : S::switch_on_disabled;
  if (from == S::switched_on && goal == S::quick_stop_active) return S::operation_enabled;
  return goal;
}

}  // namespace

const char* to_string(Cia402State state) {
  switch (state) {
    case S::not_ready: return "not ready to switch on";
    case S::switch_on_disabled: return "switch on disabled";
    case S::ready_to_switch_on: return "ready to switch on";
    case S::switched_on: return "switched on";
    case S::operation_enabled: return "operation enabled";
    case S::quick_stop_active: return "quick stop active";
    case S::fault_reaction_active: return "fault reaction active";
    case S::fault: return "fault";
  }
  return "?";
}

std::optional<Cia402State> state_of(std::uint16_t status) noexcept {
  switch (status & 0x4f) {
    case 0x00: return S::not_ready;
    case 0x40: return S::switch_on_disabled;
    case 0x0f: return S::fault_reaction_active;
    case 0x08: return S::fault;
    default: break;
  }
  switch (status & 0x6f) {
    case 0x21: return S::ready_to_switch_on;
    case 0x23: return S::switched_on;
    case 0x27: return S::operation_enabled;
    case 0x07: return S::quick_stop_active;
    default: return std::nullopt;
  }
}

const char* to_string(Cia402Command command) {
  switch (command) {
    case C::shutdown: return "shutdown";
    case C::switch_on: return "switch on";
    case C::enable_operation: return "enable operation";
    case C::disable_operation: return "disable operation";
    case C::disable_voltage: return "disable voltage";
    case C::quick_stop: return "quick stop";
    case C::fault_reset: return "fault reset";
  }
  return "?";
}

std::uint16_t control_word(Cia402Command command) noexcept {
  switch (command) {
    case C::shutdown: return 0x06;
    case C::switch_on:
    case C::disable_operation: return 0x07;
    case C::enable_operation: return 0x0f;
    case C::disable_voltage: return 0x00;
    case C::quick_stop: return 0x02;
    case C::fault_reset: return 0x80;
  }
  return 0;
}

Cia402Command command_of(std::uint16_t control) noexcept {
  if (control & 0x80) return C::fault_reset;
  if (!(control & 0x02)) return C::disable_voltage;
  if (!(control & 0x04)) return C::quick_stop;
  if (!(control & 0x01)) return C::shutdown;
  return control & 0x08 ? C::enable_operation : C::switch_on;
}

std::span<const Transition> transitions() noexcept {
  return kTransitions;
}

std::optional<int> transition_between(Cia402State from, Cia402State to) noexcept {
  if (to == S::fault_reaction_active && from != S::fault && from != to) return 13;
  const auto found = std::find_if(std::begin(kTransitions), std::end(kTransitions),
                                  [&](const Transition& t) { return t.from == from && t.to == to; });
  if (found != std::end(kTransitions)) return found->number;
  // A reaction that is over before the next status word: 13 and 14 at once.
  return to == S::fault && from != S::fault ? std::optional<int>(13) : std::nullopt;
}

std::optional<Cia402Command> next_command(Cia402State from, Cia402State goal) noexcept {
  if (from == goal) return std::nullopt;
  const S to = from == S::fault ? S::switch_on_disabled : next_state(from, goal);
  const auto found = std::find_if(std::begin(kTransitions), std::end(kTransitions),
                                  [&](const Transition& t) { return t.from == from && t.to == to; });
  return found == std::end(kTransitions) ? std::nullopt : found->command;
}

const char* to_string(OperationMode mode) {
  switch (mode) {
    case OperationMode::none: return "no mode";
    case OperationMode::profile_position: return "profile position";
    case OperationMode::homing: return "homing";
    case OperationMode::cyclic_position: return "cyclic synchronous position";
    case OperationMode::cyclic_velocity: return "cyclic synchronous velocity";
  }
  return "another mode";
}

}  // namespace foresight::canopen

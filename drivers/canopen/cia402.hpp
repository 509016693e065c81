// Words, states and modes of a drive (CiA 402-2, clauses 8 to 10). Pure.
#pragma once

#include <cstdint>
#include <optional>
#include <span>

namespace foresight::canopen {

/// The states of the power drive state machine (CiA 402-2, figure 7).
enum class Cia402State : std::uint8_t {
  not_ready,
  switch_on_disabled,
  ready_to_switch_on,
  switched_on,
  operation_enabled,
  quick_stop_active,
  fault_reaction_active,
  fault,
};
const char* to_string(Cia402State state);

/// From the status word 6041h; nothing where its bits name no state.
std::optional<Cia402State> state_of(std::uint16_t status) noexcept;

/// Status word bits beside those of the state.
inline constexpr std::uint16_t kStatusTargetReached = 1u << 10, kStatusLimit = 1u << 11;
inline constexpr std::uint16_t kStatusBit12 = 1u << 12;  ///< csp: follows; hm: attained; pp: set-point taken
inline constexpr std::uint16_t kStatusBit13 = 1u << 13;  ///< csp and pp: following error; hm: homing error
/// Control word bits beside those of the command.
inline constexpr std::uint16_t kControlBit4 = 1u << 4;    ///< hm: start; pp: new set-point
inline constexpr std::uint16_t kControlAtOnce = 1u << 5;  ///< pp: do not wait for the last set-point's end

enum class Cia402Command : std::uint8_t {
  shutdown,
  switch_on,  ///< the same word as disable_operation; which one it is depends on the state
  enable_operation,
  disable_operation,
  disable_voltage,
  quick_stop,
  fault_reset,  ///< acts on the rising edge of bit 7
};
const char* to_string(Cia402Command command);
/// The control word 6040h with all other bits 0.
std::uint16_t control_word(Cia402Command command) noexcept;
/// The command that a control word means (in a drive that is not switched on, 7h is "switch on").
Cia402Command command_of(std::uint16_t control) noexcept;

/// One transition; `command` is absent for those that the drive makes by itself.
struct Transition {
  int number = 0;  ///< 0 .. 16, as in CiA 402-2
  Cia402State from{}, to{};
  std::optional<Cia402Command> command;
};
/// All but 0 (power-on) and 13 (any state to fault reaction). Where more than one command makes a
/// transition, each has its row.
std::span<const Transition> transitions() noexcept;
/// The number of the transition between two states, 13 and the direct entry to fault included; nothing
/// where the standard has none.
std::optional<int> transition_between(Cia402State from, Cia402State to) noexcept;

/// The command for the next step from `from` towards `goal` (one of switch_on_disabled .. quick_stop_active);
/// nothing where the drive has to move by itself first, or is there.
std::optional<Cia402Command> next_command(Cia402State from, Cia402State goal) noexcept;

enum class OperationMode : std::int8_t {
  none = 0,
  profile_position = 1,
  homing = 6,
  cyclic_position = 8,
  cyclic_velocity = 9,
};
const char* to_string(OperationMode mode);
/// Its bit in 6502h, supported drive modes.
constexpr std::uint32_t mode_bit(OperationMode mode) {
  return mode == OperationMode::none ? 0 : 1u << (static_cast<int>(mode) - 1);
}

}  // namespace foresight::canopen

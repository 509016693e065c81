// The Schunk Motion Protocol (SMP), which newer Schunk modules speak instead of the PowerCube protocol.
//
// A message is [D-Len][command][parameters], D-Len counting command and parameters; little-endian, floats binary32.
// On CAN the identifier is 0x500 + module (master to module), 0x700 + module (module to master) or 0x300 + module
// (errors). Messages of more than 8 bytes (longer states), which CAN splits, are not read. Only understood, for logs of
// their buses; no drive of a rig speaks it. Source: SCHUNK Motion Protocol 1.41, and the byte examples of its manual.
#pragma once

#include <optional>
#include <span>
#include <string>

#include "drivers/can/can_frame.hpp"

namespace foresight::powercube {

enum class MotionCommand : std::uint8_t {
  error = 0x88,             ///< module: `code`
  warning = 0x89,           ///< module: `code`
  info = 0x8A,              ///< module: `code`, 16 bits
  acknowledge = 0x8B,       ///< master: error seen; module: ok
  reference = 0x92,         ///< homes; answered ok, and when done by move_blocked
  move_blocked = 0x93,      ///< module, of its own: stands at `value`
  position_reached = 0x94,  ///< module, of its own: stands at `value`
  get_state = 0x95,         ///< master: every `value` seconds, `mask`; module: `value` (position), `state`, `code`
  move_position = 0xB0,     ///< master: to `value`; module: will be there in `value` seconds
  move_current = 0xB3,      ///< master: `value` A; module: ok
  move_velocity = 0xB5,     ///< master: `value` per second; module: ok
  check = 0xE4,             ///< master: `mask` and `state` choose the test; module: `value`, `mask`, `state`
};

enum class MotionSender : std::uint8_t { master, module, module_error };

/// Positions and velocities in the module's unit: mm or degrees.
struct MotionMessage {
  MotionSender sender = MotionSender::master;
  int module = 0;  ///< 0 .. 127
  MotionCommand command = MotionCommand::acknowledge;
  std::optional<float> value{};         ///< see MotionCommand
  std::optional<std::uint8_t> mask{};   ///< get_state: 01 position, 02 velocity, 04 current; check: first test byte
  std::optional<std::uint8_t> state{};  ///< get_state: bits; check: second test byte
  std::optional<std::uint16_t> code{};  ///< error, warning, info, and the error in a state; 0: none
  bool ok = false;                      ///< the module says "OK": understood
  bool wrong_length = false;            ///< D-Len did not fit what came; read by what came (a misprint in the manual)

  friend bool operator==(const MotionMessage&, const MotionMessage&) = default;
};

/// [D-Len][command][parameters] (and nothing else) as `sender` sent it; nothing: not a message listed above.
std::optional<MotionMessage> decode_motion(MotionSender sender, int module, std::span<const std::uint8_t> bytes);
std::optional<MotionMessage> decode_motion(const CanFrame& frame);

/// "ERROR MOTOR VOLTAGE LOW"; "unknown code" for codes that our source does not name. Static text.
const char* motion_code(std::uint16_t code) noexcept;
/// In words; units are the module's own.
std::string describe(const MotionMessage& message);

}  // namespace foresight::powercube

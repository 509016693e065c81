// The messages of Amtec/Schunk PowerCube modules (firmware "M5") on CAN: made, read and put into words.
//
// Identifiers (11 bits) carry the module id 1 .. 31; the first data byte is the command:
//
//   0x0A0 + id   module -> host   answers
//   0x0C0 + id   host -> module   Get
//   0x0E0 + id   host -> module   Set, commands and motions
//   0x100        host -> all      broadcasts, never answered
//
// Little-endian; floats are IEEE 754 binary32, in rad (rotary) or m (linear), rad/s or m/s, A.
// Source: numbers on which two independent public implementations agree (RobWork's PCubeProtocol, and the PowerCube
// library of C. Smith, KTH, 2005). Not in that source, and so only tolerated, never relied upon: the answers to
// SetExtended ([08][param][64]) and to plain commands ([command], or [command][64]).
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "drivers/can/can_frame.hpp"

namespace foresight::powercube {

inline constexpr int kLargestModule = 31;
inline constexpr std::uint32_t kAnswerId = 0x0A0, kGetId = 0x0C0, kPutId = 0x0E0, kBroadcastId = 0x100;
inline constexpr std::uint8_t kAccepted = 0x64;  ///< last byte of a simple answer

enum class Command : std::uint8_t {
  reset = 0x00,  ///< clears errors and leaves the halt
  home = 0x01,
  halt = 0x02,              ///< decelerates, then stands with closed brake until a reset
  watchdog_refresh = 0x07,  ///< broadcast only
  set_extended = 0x08,
  recalc_pid_params = 0x09,
  get_extended = 0x0A,
  set_motion = 0x0B,
  set_istep = 0x0D,
  save_pos = 0x0E,     ///< broadcast only
  sync_motion = 0x0F,  ///< broadcast only
};
inline constexpr std::uint8_t kBroadcastSetBaud = 0x09;  ///< shares its code with recalc_pid_params

/// The parameters that we use; all others by find_param().
enum class Param : std::uint8_t {
  def_min_pos = 0x03,
  def_max_pos = 0x04,
  def_max_vel = 0x0A,
  def_max_acc = 0x0C,
  def_home_vel = 0x0F,
  def_cube_serial = 0x1A,
  def_cube_version = 0x1D,
  cube_state = 0x27,
  config = 0x39,
  act_pos = 0x3C,
  act_vel = 0x41,
  min_pos = 0x45,
  max_pos = 0x46,
  max_vel = 0x48,
  max_acc = 0x4A,
  target_vel = 0x4F,
  target_acc = 0x50,
};

enum class ValueType : std::uint8_t { float32, int32, uint32, int16, uint16, uint8 };
struct ParamInfo {
  Param code;
  const char* name;  ///< "ActPos"
  ValueType type;
};
const ParamInfo* find_param(std::uint8_t code) noexcept;      ///< null: no parameter
const ParamInfo* find_param(std::string_view name) noexcept;  ///< exact name; null: no parameter
std::string nearest_param(std::string_view name);             ///< for a message about a wrong name

/// Motions with a simple answer, and (from framp_ack) with one that tells position and short state.
enum class Motion : std::uint8_t {
  framp = 0x04,  ///< to a position with TargetVel and TargetAcc
  fstep = 0x06,  ///< to be at a position in so many milliseconds
  fvel = 0x07,
  fcur = 0x08,
  iramp = 0x09,
  istep = 0x0B,
  ivel = 0x0C,
  icur = 0x0D,
  framp_ack = 0x0E,
  fstep_ack = 0x10,
  fvel_ack = 0x11,
  fcur_ack = 0x12,
  iramp_ack = 0x13,
  istep_ack = 0x15,
  ivel_ack = 0x16,
  icur_ack = 0x17,
};
struct MotionInfo {
  Motion code;
  const char* name;  ///< "FSTEP_ACK"
  ValueType type;
  bool timed;     ///< milliseconds follow the target
  bool extended;  ///< answered with position and short state
};
const MotionInfo* find_motion(std::uint8_t code) noexcept;  ///< null: no motion

/// Bits of the short state in the answer to a motion.
enum ShortState : std::uint8_t {
  kShortNotOk = 0x01,  ///< error, not homed, or halted
  kShortMotion = 0x10,
  kShortRampEnd = 0x20,
};

/// Bits of the parameter CubeState that decide something here; all of them by state_words().
enum State : std::uint32_t {
  kError = 0x00000001,
  kHomeOk = 0x00000002,
  kHalted = 0x00000004,
  kSwitch1 = 0x00000080,
  kSwitch2 = 0x00000100,
  kMotion = 0x00000800,
  kRampEnd = 0x00008000,
  kInProgress = 0x00010000,
  kCurrentLimit = 0x00000400,
  kBeyondHard = 0x02000000,
  kBeyondSoft = 0x04000000,
};
struct BitName {
  std::uint32_t mask;
  const char* name;     ///< "POW_SHORT_CUR"
  const char* meaning;  ///< what went wrong, in words; "" where the bit is not an error
};
std::span<const BitName> state_bits() noexcept;
std::span<const BitName> short_state_bits() noexcept;
std::span<const BitName> digital_io_bits() noexcept;
std::string words(std::uint32_t bits, std::span<const BitName> names);  ///< "HOME_OK HALTED"; "0" where none
/// The most telling error of a state word in words; "" without one. Static text.
const char* fault_of(std::uint32_t state) noexcept;

/// Code of a bit rate in DefPrimBaud, DefScndBaud and SetBaud, and back; nothing for others.
std::optional<std::uint8_t> baud_code(int kbit_per_s) noexcept;
std::optional<int> baud_rate(std::uint8_t code) noexcept;

// Made frames. `module` 1 .. 31. Values are rounded to integer types and saturate at their ends.
CanFrame get_param(int module, Param param) noexcept;
CanFrame set_param(int module, Param param, double value) noexcept;  ///< `param` of the table
CanFrame command(int module, Command what) noexcept;                 ///< one without data
CanFrame motion(int module, Motion what, double target, double milliseconds = 0) noexcept;
CanFrame set_istep(int module, std::int32_t ticks, std::uint16_t milliseconds) noexcept;
CanFrame broadcast(Command what) noexcept;

/// A frame that was read. Fields that its kind does not have are 0.
struct Message {
  enum class Kind : std::uint8_t {
    unknown,
    get,            ///< host: param
    set,            ///< host: param, value
    order,          ///< host: command
    motion,         ///< host: motion, value, milliseconds
    istep,          ///< host: value (ticks), milliseconds
    broadcast,      ///< host: code
    value,          ///< module: param, value
    set_answer,     ///< module: param, accepted
    order_answer,   ///< module: command, accepted
    motion_answer,  ///< module: motion, accepted
    position,       ///< module: motion, value (position), short_state, digital_io
  };
  Kind kind = Kind::unknown;
  int module = 0;
  std::uint8_t code = 0;  ///< of the parameter, motion or command, by kind
  double value = 0;       ///< every wire type fits exactly
  std::uint16_t milliseconds = 0;
  std::uint8_t short_state = 0, digital_io = 0;
  bool accepted = false;

  bool from_host() const { return kind >= Kind::get && kind <= Kind::broadcast; }
  bool from_module() const { return kind >= Kind::value; }
  bool is(Kind k, Param p) const { return kind == k && code == static_cast<std::uint8_t>(p); }
};
/// Reads any frame; `unknown` for what is not exactly one of the messages above.
Message decode(const CanFrame& frame) noexcept;

/// A frame in words, for logs: "module 3: ActPos = 0.5"; "unknown" for what decode() does not know.
std::string describe(const CanFrame& frame);

}  // namespace foresight::powercube

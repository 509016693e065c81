// A motor on a bus, whatever protocol it speaks: what CiA 402 and PowerCube have in common.
#pragma once

#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "common/time.hpp"
#include "drivers/can/can_bus.hpp"

namespace foresight {

/// How a joint's motor is reached and scaled. Joint units: rad (or m), after gear and offset.
struct DriveConfig {
  std::string name;                               ///< the joint's name, for messages
  int node = 0;                                   ///< CANopen node id 1 .. 127, PowerCube module id 1 .. 31
  double counts_per_unit = 1;                     ///< CiA 402: position increments per rad (or m) of the joint; > 0
  int direction = 1;                              ///< +1, or -1 where the motor turns against the joint
  double offset = 0;                              ///< joint position where the drive says 0
  double min_position = 0, max_position = 0;      ///< written into the drive where it takes them
  double max_velocity = 0, max_acceleration = 0;  ///< > 0
  double homing_velocity = 0.05;                  ///< > 0, slow
  /// What the device must say of itself; absent: anything. A device that says otherwise is never moved.
  std::optional<std::uint32_t> vendor, product, serial;
};

/// What a device says of itself; absent where it does not.
struct DriveIdentity {
  std::optional<std::uint32_t> vendor, product, serial;
};
/// As the keys of a joint in a rig file: "vendor: 0x10, product: 0x20, serial: 30"; "" where it says nothing.
std::string to_text(const DriveIdentity& identity);

enum class DriveState : std::uint8_t {
  offline,   ///< nothing heard of it in time (heartbeat, answer)
  disabled,  ///< reachable, no torque (brake holds)
  enabling,
  enabled,  ///< follows set-points
  homing,
  stopping,  ///< decelerates after a quick stop or a halt
  fault,
};
const char* to_string(DriveState state);

/// What a drive last told. A plain value.
struct DriveFeedback {
  RobotTime time;                                              ///< when the position was received; 0: never
  double position = std::numeric_limits<double>::quiet_NaN();  ///< joint units
  double velocity = std::numeric_limits<double>::quiet_NaN();
  DriveState state = DriveState::offline;
  bool homed = false;
  bool target_reached = false;
  bool limit = false;            ///< the drive itself limits: a limit switch, soft limit or its following error
  std::uint32_t fault_code = 0;  ///< CiA 402: EMCY / 603Fh code; PowerCube: state word
  const char* fault = "";        ///< its meaning; static text
};

enum class DriveRequest : std::uint8_t {
  none,
  enable,      ///< holds where it stands
  disable,     ///< no torque, brake closes
  quick_stop,  ///< decelerates and holds
  home,        ///< slowly; only from enabled
  reset_fault,
};

/// One drive. One thread. From construction to configure(): set-up, which blocks (at most a second a
/// step) and throws; after that the loop's methods, which do neither and do not allocate.
class Drive {
 public:
  virtual ~Drive() = default;
  virtual const DriveConfig& config() const noexcept = 0;

  /// Reads what the device is and compares it with the rig. Moves nothing.
  /// Throws InputError (another device, naming both) or RuntimeFailure (no answer).
  virtual void identify() = 0;
  /// As the last identify() found it.
  virtual DriveIdentity identity() const = 0;
  /// Writes limits, mappings and the watchdog that stops the drive when we fall silent, and reads each
  /// back. A drive without a proven watchdog cannot be enabled. Throws as identify().
  virtual void configure() = 0;
  /// What the device lacks or keeps of its own, one line each, as the last configure() found it.
  virtual std::vector<std::string> remarks() const { return {}; }

  /// Asks for a change of state; it takes some cycles, seen in feedback(). Safe at any time: a request that
  /// does not fit the state (homing while disabled) is dropped. `quick_stop` overrides all others.
  virtual void request(DriveRequest what) noexcept = 0;
  /// Where to be at the next cycle, and how fast to pass there (joint units); ignored unless enabled.
  /// Not finite: ignored too, the drive holds its last set-point.
  virtual void set_point(double position, double velocity) noexcept = 0;
  virtual DriveFeedback feedback() const noexcept = 0;
};

/// Drives that share a bus and a protocol, and what the protocol sends for all of them (SYNC, heartbeat,
/// watchdog). One thread; in the loop: receive(), requests and set-points, send(), once a cycle.
class DriveNetwork {
 public:
  virtual ~DriveNetwork() = default;
  virtual std::span<Drive* const> drives() const noexcept = 0;
  /// Takes in all frames that have arrived, without waiting; marks drives that fell silent.
  virtual void receive(RobotTime now) noexcept = 0;
  /// Sends what is due: SYNC, watchdog, state transitions, set-points.
  virtual void send(RobotTime now) noexcept = 0;
  /// The bus is usable, and no other master was seen on it.
  virtual bool healthy() const noexcept = 0;
  virtual const char* reason() const noexcept = 0;  ///< why not; static text, "" where healthy
};

}  // namespace foresight

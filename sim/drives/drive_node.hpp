// What the emulated drives of all protocols have in common.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "drivers/can/can_frame.hpp"
#include "sim/drives/motor.hpp"

namespace foresight::sim {

/// What a test, or a user, does to a drive. A state lasts until `recover`; an event happens once.
enum class DriveFault : std::uint8_t {
  recover,         ///< ends all states below
  overcurrent,     ///< event: the drive finds a short circuit
  tow_error,       ///< event: the shaft lags too far behind
  emergency,       ///< event: an EMCY frame with the error code `value`, without any effect (CiA 402 only)
  reset,           ///< event: loss and return of logic supply; in motion the shaft runs out
  silent,          ///< state: sends nothing more, but goes on
  frozen,          ///< state: tells the position and velocity of the moment for ever
  garbage,         ///< state: tells arbitrary positions and velocities; PowerCube: also NaN and infinity
  wrong_identity,  ///< state: tells a serial number and product that are not its own
  slow,            ///< state: every frame leaves `value` seconds late
  jam,             ///< state: the shaft is held fast by something outside
  noisy,           ///< state: what it tells of its position is off by up to `value`, each time otherwise
  unplugged,       ///< state: neither hears nor is heard, but goes on
  no_power,        ///< state: no supply; afterwards as after a reset
};
/// "tow-error"; for command lines.
const char* to_string(DriveFault fault);

struct NodeConfig {
  enum class Kind : std::uint8_t { cia402, powercube };
  Kind kind = Kind::cia402;
  int node = 1;                                 ///< CiA 402: 1 .. 127; PowerCube: 1 .. 31
  std::string name;                             ///< for messages and faults; not empty
  double counts_per_unit = 100'000;             ///< > 0: what the drive counts per rad (or m) of the joint
  double min_position = 0, max_position = 0;    ///< soft limits of the drive, joint units; none where min >= max
  bool homed = false;                           ///< absolute encoder: knows its position from power on
  double home_position = 0;                     ///< joint position of a PowerCube's home switch
  double low_switch = -1e9, high_switch = 1e9;  ///< joint positions beyond which the limit switches close
  double home_switch_low = 1,
         home_switch_high = 0;  ///< CiA 402: between them the home switch closes; none where low > high
  double index_distance = 0.0628, index_at = 0;  ///< CiA 402: > 0; the encoder's index pulses, one of them at index_at
  std::vector<int> homing_methods;               ///< CiA 402, 60E3h; empty: all of served_homing_methods()
  /// After so many missed cyclic set-points the drive faults; until then it goes on at its last velocity.
  int missed_set_points = 3;
  bool hold_when_missed = false;  ///< instead of the fault it stops, and waits for set-points
  double watchdog_s = 0.1;        ///< PowerCube: silence that its watchdog allows; > 0
  std::uint32_t vendor = 0x000F0E51, product = 1, revision = 1, serial = 1;
  std::filesystem::path dictionary;  ///< CiA 402: EDS or DCF file; empty: generic_402()
  MotorConfig motor;

  /// Throws InputError naming `name`, the field and the value.
  void validate() const;
};

/// One emulated drive on the bus. Never throws after construction. One thread.
class DriveNode {
 public:
  using Send = std::function<void(const CanFrame&)>;
  virtual ~DriveNode() = default;
  /// A frame of the bus, of anybody; error frames are ignored.
  virtual void receive(const CanFrame& frame, RobotTime now) = 0;
  /// Moves protocol and shaft on to `now`, `dt` <= 1 ms after the last step.
  virtual void step(RobotTime now, double dt) = 0;
  virtual void inject(DriveFault fault, double value) = 0;

  const NodeConfig& config() const { return config_; }
  const ShaftState& shaft() const { return motor_.shaft(); }
  void forget_extremes() { motor_.forget_extremes(); }

 protected:
  explicit DriveNode(const NodeConfig& config) : config_(config), motor_(config.motor) {}
  /// The next of a fixed series of numbers from -1 to 1.
  double arbitrary();

  NodeConfig config_;
  Motor motor_;
  /// What the encoder reads: the shaft's position, with noise where there is some.
  double encoder() { return shaft().position + (noise_ > 0 ? noise_ * arbitrary() : 0); }

  bool frozen_ = false, garbage_ = false;
  double noise_ = 0;

 private:
  std::uint32_t arbitrary_ = 12345;
};

}  // namespace foresight::sim

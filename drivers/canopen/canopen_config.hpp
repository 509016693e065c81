// What a rig says about its CANopen bus and the drives on it.
#pragma once

#include "drivers/canopen/cia402.hpp"
#include "drivers/drive/drive.hpp"

namespace foresight::canopen {

inline constexpr Duration kShortestCycle = std::chrono::microseconds(100);
inline constexpr int kCyclesOfFeedback = 3;  ///< that feedback_timeout lasts, at least

/// What all nodes of a bus share. Times are rounded to the millisecond that CANopen counts in.
struct NetworkConfig {
  int master_node = 127;                                       ///< 1 .. 127, of no drive; our heartbeat's
  Duration cycle = std::chrono::milliseconds(10);              ///< of send(), hence of SYNC; 100 us .. 255 ms
  Duration heartbeat = std::chrono::milliseconds(20);          ///< ours; at most a third of `watchdog`
  Duration watchdog = std::chrono::milliseconds(100);          ///< silence of ours after which a drive stops (1016h)
  Duration drive_heartbeat = std::chrono::milliseconds(50);    ///< theirs (1017h)
  Duration drive_timeout = std::chrono::milliseconds(160);     ///< more than twice drive_heartbeat
  Duration feedback_timeout = std::chrono::milliseconds(100);  ///< without a position, at least kCyclesOfFeedback
  Duration sdo_timeout = std::chrono::milliseconds(300);       ///< for one answer
};

struct Cia402Config {
  DriveConfig drive;
  OperationMode mode = OperationMode::cyclic_position;  ///< or profile_position, cyclic_velocity
  /// 6098h (CiA 402-2, 8.2), such as 1 (negative limit switch and index) or 37 (here is home); 0: no homing.
  int homing_method = 0;
  double homing_acceleration = 0;  ///< joint units/s^2; 0: max_acceleration
  /// Velocity increments of the drive per (position increment/s). The standard's default unit makes it 1.
  double velocity_factor = 1;
  bool absolute_encoder = false;  ///< the drive knows its position from power-on: homed from the start
  /// 605Ah: 5 .. 8 decelerate and hold in "quick stop active"; 6 by the quick stop ramp 6085h.
  int quick_stop_option = 6;
  double quick_stop_deceleration = 0;                ///< joint units/s^2; 0: max_acceleration
  std::optional<std::uint32_t> max_motor_speed_rpm;  ///< 6080h, where the rig says
};

/// Throw InputError that quotes the field and the bad value.
void validate(const NetworkConfig& config);
void validate(const Cia402Config& config);

}  // namespace foresight::canopen

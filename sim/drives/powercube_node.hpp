// An emulated Amtec/Schunk PowerCube module with the M5 protocol.
//
// CAN identifiers, with the module id m: 0A0h + m module to host, 0C0h + m host asks (GetExtended), 0E0h + m host
// tells (all other commands), 100h broadcast. Values are little-endian: float in rad and s, int32 in counts.
//   [00] Reset    [01] Home    [02] Halt              -> [command][64]
//   [08][parameter][value] SetExtended                -> [08][parameter][64]
//   [0A][parameter] GetExtended                       -> [0A][parameter][value]
//   [0B][motion][value..] SetMotion                   -> [0B][motion][64], or for the _ACK motions
//                                                        [0B][motion][position][short state][digital inputs]
//
// What public sources leave open, and is assumed here:
// - Reset, Home and Halt are acknowledged like SetExtended; broadcasts are not acknowledged.
// - What is refused (unknown, wrong length, not finite, out of range, motion while NOT_OK) gets no simple
//   acknowledge; an extended one always comes and shows NOT_OK.
// - Motion needs HOME_OK and neither ERROR nor HALTED; Home needs neither ERROR nor HALTED.
// - Config bit 01000000h enables the watchdog. It begins with the first refresh, which sets the bit. After
//   NodeConfig::watchdog_s of silence the module brakes with MaxAcc: ERROR, COMM_ERROR and HALTED.
// - Config bit 04000000h suppresses acknowledges (not answers of GetExtended). With 08000000h motions wait for
//   the broadcast SyncMotion.
// - Halt brakes with MaxAcc; at rest the brake closes. It opens with the next motion.
// - An FSTEP of up to 0.1 s is a cyclic set-point (see CyclicInterpolator), a longer one a movement from rest to rest
//   that takes the time given. A module that hears no further step stops at the last.
// - A target beyond MinPos or MaxPos is cut to it, and BEYOND_SOFT is set until the next target inside.
#pragma once

#include <array>
#include <optional>

#include "sim/drives/drive_node.hpp"
#include "sim/drives/reference.hpp"

namespace foresight::sim {

/// Loses its reference at a reset of the supply (unless NodeConfig::homed), as the position is not kept.
class PowerCubeNode final : public DriveNode {
 public:
  PowerCubeNode(const NodeConfig& config, Send send);
  void receive(const CanFrame& frame, RobotTime now) override;
  void step(RobotTime now, double dt) override;
  void inject(DriveFault fault, double value) override;
  std::uint32_t state_word() const;

 private:
  enum class Activity : std::uint8_t { idle, ramp, step, velocity, current, halt, homing };
  using Bytes = std::span<const std::uint8_t>;
  void power_up();
  void broadcast(std::uint8_t command, RobotTime now);
  void tell(Bytes bytes, RobotTime now);
  bool reset();
  bool home();
  bool halt();
  void refresh_watchdog(RobotTime now);
  void get(std::uint8_t parameter);
  bool set(std::uint8_t parameter, Bytes value);
  void accept_motion(Bytes bytes);
  bool move(std::uint8_t motion, Bytes value);
  void begin(Activity activity);
  double cut(double position);
  void fail(std::uint32_t bits);
  void stop_after_silence(RobotTime now);
  Reference next_reference(double dt);
  Reference next_step(double dt);
  double parameter(std::uint8_t parameter);
  double shown_position();
  std::uint8_t short_state() const;
  void acknowledge(std::initializer_list<std::uint8_t> bytes);
  void answer(Bytes bytes);
  double to_shaft(double position) const { return position + zero_; }

  Send send_;
  std::array<double, 256> values_{};  // parameters that can be set or never change
  std::uint32_t errors_ = 0;          // the lasting bits of the state word
  bool homed_ = false, beyond_soft_ = false, ramp_ended_ = false;
  double zero_ = 0, frozen_position_ = 0;
  Activity activity_ = Activity::idle;
  Reference reference_;
  double target_ = 0, current_ = 0;
  CyclicInterpolator steps_;
  std::optional<RobotTime> refreshed_;
  std::optional<std::array<std::uint8_t, 8>> waiting_;  // for SyncMotion: its bytes
  std::uint8_t waiting_size_ = 0;
  double deaf_s_ = 0;  // while it boots
};

}  // namespace foresight::sim

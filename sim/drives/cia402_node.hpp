// An emulated servo drive after CiA 402-2 and 402-3, on CANopen.
//
// Units on the wire: positions in counts (counts_per_unit), velocities in counts/s, accelerations in counts/s^2.
// Faults it finds itself: 2310h short circuit, 8130h heartbeat lost (as 6007h says), 8250h set-points missed,
// 8611h following error.
#pragma once

#include "sim/drives/canopen_node.hpp"
#include "sim/drives/cia402_motion.hpp"
#include "sim/drives/cia402_states.hpp"

namespace foresight::sim {

/// Objects that its dictionary lacks have the values of generic_402(). Modes are those of cia402_motion.hpp that
/// 6502h allows.
class Cia402Node final : public CanopenNode {
 public:
  /// Throws InputError where the dictionary file cannot be read.
  Cia402Node(const NodeConfig& config, Send send);
  void inject(DriveFault fault, double value) override;

 private:
  void run(RobotTime now, double dt) override;
  void refresh() override;
  SdoAbort check(std::uint32_t key, std::int64_t value) override;
  void written(std::uint32_t key, bool by_pdo) override;
  void synchronised(RobotTime now) override;
  void connection_lost() override;
  void restarted() override;

  void control();
  void control_profile(std::uint16_t controlword);
  void control_homing(std::uint16_t controlword);
  void load_settings();
  void power(bool on);
  void fail(std::uint16_t code, std::uint8_t bits);
  void take_events();
  std::uint16_t statusword() const;
  std::uint16_t mode_bits() const;
  unsigned switches() const;
  bool serves_homing(std::int64_t method) const;
  double to_shaft(double counts) const { return counts / config_.counts_per_unit + zero_; }
  std::int64_t to_counts(double shaft) const;
  double scaled(unsigned index, unsigned sub, double otherwise) const;

  PowerStates states_;
  Cia402Motion motion_;
  double zero_ = 0;  // shaft position where the drive counts 0
  std::uint16_t controlword_ = 0, error_code_ = 0;
  bool acknowledge_ = false, homed_ = false, homing_failed_ = false, following_error_ = false;
};

}  // namespace foresight::sim

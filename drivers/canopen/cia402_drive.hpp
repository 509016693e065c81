// A motor behind a CiA 402 drive. Made by CanopenNetwork, which gives it its frames.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "drivers/canopen/canopen_config.hpp"
#include "drivers/canopen/cia402_machine.hpp"
#include "drivers/canopen/emcy.hpp"
#include "drivers/canopen/nmt.hpp"
#include "drivers/canopen/pdo.hpp"
#include "drivers/canopen/sdo_access.hpp"

namespace foresight::canopen {

/// Which of a node's frames one is, by its COB-ID.
enum class NodeFrame : std::uint8_t { heartbeat, emergency, sdo_answer, tpdo1, tpdo2 };

/// Process data, sent with or sampled at every SYNC (transmission type 1):
///   RPDO1  control word 6040h, target position 607Ah (in mode cyclic_velocity: target velocity 60FFh)
///   TPDO1  status word 6041h, actual position 6064h
///   TPDO2  actual velocity 606Ch, mode shown 6061h
/// All other PDOs 2 .. 4 of the node are switched off. Node restart, loss of the state "operational": configure()
/// again. Loss of heartbeat or process data: a quick stop is sent, and nobody but a request enables it again,
/// at the actual position.
///
/// An incremental encoder's zero is that of the last homing for as long as the drive provably kept its power: neither a
/// boot-up message came (CiA 301, 7.2.8.3.3) nor was the node silent for longer than `drive_timeout`, in which one
/// might have been missed. That is watched from homing on, whether the drive is set up or not. One thread.
class Cia402Drive final : public Drive {
 public:
  /// `bus`, `clock` outlive the drive. Throws InputError (validate()).
  Cia402Drive(Cia402Config config, const NetworkConfig& network, CanBus& bus, Clock& clock, SdoAccess::Pump pump);

  const DriveConfig& config() const noexcept override { return config_.drive; }
  /// Reads 1000h (profile 402) and 1018h, whose product and serial number need not exist. Takes at most 2 sdo_timeout
  /// an object.
  void identify() override;
  DriveIdentity identity() const override { return identity_; }
  /// Leaves the node operational, switched off. Moves nothing; a drive found enabled is stopped first.
  /// Other drives of the bus get no SYNC meanwhile: disable them before. A device without 1016h, 6007h or 1017h
  /// does not throw: refusal() tells, and enabling is refused. Throws RuntimeFailure where the node restarts meanwhile,
  /// and with it forgets what was written. remarks() tell where its zero is lost.
  void configure() override;
  void request(DriveRequest what) noexcept override;
  void set_point(double position, double velocity) noexcept override;
  DriveFeedback feedback() const noexcept override;

  /// Why enabling is refused; static text, "" where it is not.
  const char* refusal() const noexcept { return refusal_; }
  std::vector<std::string> remarks() const override { return notes_; }
  const Cia402Machine& machine() const noexcept { return machine_; }
  std::span<const Pdo> pdos() const noexcept { return pdos_; }  ///< RPDO1, TPDO1, TPDO2

  /// For the network. A frame of this node; one that is malformed for its COB-ID changes nothing.
  void receive(NodeFrame what, const CanFrame& frame, RobotTime now) noexcept;
  void check(RobotTime now) noexcept;  ///< timeouts
  /// RPDO1 of this cycle; nothing where the node must not get one. `permitted`: the network is healthy.
  std::optional<CanFrame> command(bool permitted, RobotTime now) noexcept;

 private:
  // cia402_setup.cpp
  std::optional<std::uint32_t> told(ObjectRef object, const char* what, std::optional<std::uint32_t> wanted);
  void switch_off();
  void prove_heartbeats();
  void write_error_behaviour();
  void prove_abort_option();
  void write_limits();
  void write_limit(ObjectRef object, std::int64_t value, const char* what);
  void require_homing_method();
  void write_homing();
  void write_mode();
  void write_interpolation();
  void write_pdos();
  void start();
  void require_no_restart() const;
  void refuse(const char* why);
  std::int64_t counts_rate(double joint_rate) const;

  // cia402_drive.cpp
  void lose(const char* why) noexcept;
  void heard(const Heartbeat& heartbeat, RobotTime at) noexcept;
  void note_restart() noexcept;
  void note_silence(RobotTime now) noexcept;
  bool homed() const noexcept;
  void take_emergency(const Emergency& emergency) noexcept;
  void switch_mode(RobotTime now) noexcept;
  std::uint16_t strobe(std::uint16_t word) noexcept;
  void hold() noexcept;
  std::int32_t to_counts(double position) const noexcept;
  double to_joint(std::int64_t counts) const noexcept;
  bool is(OperationMode mode) const noexcept { return config_.mode == mode; }

  Cia402Config config_;
  NetworkConfig network_;
  CanBus& bus_;
  Clock& clock_;
  SdoClient sdo_;
  SdoAccess access_;
  std::vector<Pdo> pdos_;
  HeartbeatConsumer heartbeat_;
  Cia402Machine machine_;
  DriveIdentity identity_;
  std::vector<std::string> notes_;
  const char* refusal_ = "";
  const char* lost_ = "";       // why set-up does not hold any more
  const char* zero_lost_ = "";  // why the last homing does not
  bool restarted_ = false;      // since set-up began to write

  bool configured_ = false, online_ = false, has_heartbeat_ = false;
  bool process_seen_ = false;  // since set-up, or since it was lost
  RobotTime process_time_;     // of the position; 0: never
  int unanswered_ = 0;         // RPDOs since the last TPDO1
  std::uint16_t status_ = 0;
  std::int64_t actual_ = 0;
  std::int64_t speed_ = 0;
  bool speed_seen_ = false;
  int mode_shown_ = 0;
  OperationMode mode_written_ = OperationMode::none;
  bool switching_ = false;    // a write of the mode is under way
  bool mode_failed_ = false;  // it was refused
  bool error_told_ = false;
  std::uint16_t fault_code_ = 0;

  std::int64_t target_ = 0;  // increments; increments/s in mode cyclic_velocity
  std::int64_t wanted_ = 0;  // profile_position: the next target
  bool wanted_new_ = false, strobe_ = false;
};

}  // namespace foresight::canopen

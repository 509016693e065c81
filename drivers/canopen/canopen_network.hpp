// The master of a CANopen bus with CiA 402 drives.
#pragma once

#include <array>
#include <memory>
#include <span>
#include <vector>

#include "common/clock.hpp"
#include "drivers/canopen/cia402_drive.hpp"

namespace foresight::canopen {

/// Set-up: identify() and configure() of each drive wait here for their answers, and the heartbeat goes on
/// meanwhile; from the first configure() on, the drives stop themselves where send() or set-up pauses for longer
/// than `watchdog`. Loop: receive(), requests and set-points, send(), every `config.cycle`. send() puts RPDOs first and
/// SYNC behind them, so that set-points count at once and positions are those of that instant.
/// Another master on the bus (frames that only a master sends, and not we) ends enabling for good: every
/// enabled drive gets a quick stop. One thread.
class CanopenNetwork final : public DriveNetwork {
 public:
  /// `bus` and `clock` outlive the network. Sends nothing yet. Throws InputError: a config out of range, a
  /// node id twice.
  CanopenNetwork(CanBus& bus, Clock& clock, const NetworkConfig& config, const std::vector<Cia402Config>& drives);

  std::span<Drive* const> drives() const noexcept override { return pointers_; }
  Cia402Drive& drive(std::size_t i) { return *drives_[i]; }  ///< in the order of the configs
  void receive(RobotTime now) noexcept override;
  void send(RobotTime now) noexcept override;
  bool healthy() const noexcept override { return *reason() == 0; }
  const char* reason() const noexcept override;

 private:
  enum class Kind : std::uint8_t { none, nmt, sync, own_heartbeat, master_request, node };
  struct Slot {
    Kind kind = Kind::none;
    NodeFrame what{};
    std::uint8_t drive = 0;
  };
  void assign(std::uint32_t id, Slot slot) { slots_[id] = slot; }
  void dispatch(const CanFrame& frame, RobotTime now) noexcept;
  void pump(RobotTime until);

  CanBus& bus_;
  Clock& clock_;
  NetworkConfig config_;
  std::vector<std::unique_ptr<Cia402Drive>> drives_;
  std::vector<Drive*> pointers_;
  std::array<Slot, 0x800> slots_{};  // by COB-ID
  HeartbeatProducer heartbeat_;
  const char* other_master_ = "";
};

}  // namespace foresight::canopen

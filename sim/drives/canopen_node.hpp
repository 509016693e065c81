// An emulated CANopen node: NMT, SDO, PDO, SYNC, heartbeats and emergencies (CiA 301 v4.2). What the node is for is
// left to the class on top.
#pragma once

#include "sim/drives/drive_node.hpp"
#include "sim/drives/heartbeats.hpp"
#include "sim/drives/object_dictionary.hpp"
#include "sim/drives/pdo_set.hpp"
#include "sim/drives/sdo_server.hpp"

namespace foresight::sim {

/// States of CiA 301, 7.3.2.2, as the heartbeat tells them.
enum class NmtState : std::uint8_t { initialising = 0, stopped = 4, operational = 5, pre_operational = 0x7f };

/// Stores nothing: after a reset all objects are as configured. Boots 10 ms after a reset, at once after construction.
class CanopenNode : public DriveNode {
 public:
  void receive(const CanFrame& frame, RobotTime now) final;
  void step(RobotTime now, double dt) final;

 protected:
  CanopenNode(const NodeConfig& config, ObjectDictionary dictionary, Send send);

  // Hooks. Keys are object_key()s.
  virtual void run(RobotTime now, double dt) = 0;                     ///< the application's part of step()
  virtual void refresh() = 0;                                         ///< bring measured objects up to date
  virtual SdoAbort check(std::uint32_t key, std::int64_t value) = 0;  ///< may `value` be written now?
  virtual void written(std::uint32_t key, bool by_pdo) = 0;
  virtual void synchronised(RobotTime now) = 0;  ///< SYNC came; synchronous PDOs have been applied
  virtual void connection_lost() = 0;            ///< a heartbeat was lost, or NMT stopped the node
  virtual void restarted() = 0;                  ///< all objects are as after power on

  /// Sends EMCY and records it in 1003h; `bits` of the error register 1001h stay set until clear_errors().
  void emergency(std::uint16_t code, std::uint8_t bits);
  void clear_errors();  ///< error register 0, EMCY 0000h
  void restart(RobotTime now);
  RobotTime now() const { return now_; }
  bool alive() const { return nmt_ != NmtState::initialising; }

  ObjectDictionary objects_;

 private:
  SdoAbort read(std::uint32_t key, std::vector<std::uint8_t>& value);
  SdoAbort write(std::uint32_t key, std::vector<std::uint8_t> value, bool exact);
  SdoAbort check_range(std::uint32_t key, const ObjectEntry& entry, std::int64_t value);
  void write_mapped(std::uint32_t key, std::span<const std::uint8_t> value);
  void store(std::uint32_t key, bool by_pdo);
  void command(std::uint8_t command, RobotTime now);
  void boot(RobotTime now);
  void reload();
  void enter(NmtState state);
  void produce_heartbeat(RobotTime now);
  void watch_masters(RobotTime now);
  void send(std::uint32_t id, std::span<const std::uint8_t> bytes);

  ObjectDictionary defaults_;
  Send send_;
  SdoServer sdo_;
  PdoSet pdos_;
  HeartbeatConsumers consumers_;
  NmtState nmt_ = NmtState::initialising;
  RobotTime boot_at_, heartbeat_at_, now_;
};

}  // namespace foresight::sim

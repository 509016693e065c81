#include "drivers/canopen/canopen_network.hpp"

#include <algorithm>

#include "common/error.hpp"
#include "drivers/canopen/wire.hpp"

namespace foresight::canopen {

CanopenNetwork::CanopenNetwork(CanBus& bus, Clock& clock, const NetworkConfig& config,
                               const std::vector<Cia402Config>& drives)
    : bus_(bus), clock_(clock), config_(config), heartbeat_(config.heartbeat) {
  validate(config);
  assign(kNmtId, {Kind::nmt});
  assign(kSyncId, {Kind::sync});
  assign(kHeartbeatId + static_cast<std::uint32_t>(config.master_node), {Kind::own_heartbeat});
  for (const Cia402Config& drive : drives) {
    const auto i = static_cast<std::uint8_t>(drives_.size());
    drives_.push_back(
        std::make_unique<Cia402Drive>(drive, config, bus, clock, [this](RobotTime until) { pump(until); }));
    pointers_.push_back(drives_.back().get());
    const auto node = static_cast<std::uint32_t>(drive.drive.node);
    if (slots_[kHeartbeatId + node].kind != Kind::none)
      throw InputError("drive '" + drive.drive.name + "'", "node id " + std::to_string(node) + " is taken already",
                       "give each drive and the master a node id of its own");
    assign(kHeartbeatId + node, {Kind::node, NodeFrame::heartbeat, i});
    assign(kEmcyId + node, {Kind::node, NodeFrame::emergency, i});
    assign(kSdoAnswerId + node, {Kind::node, NodeFrame::sdo_answer, i});
    assign(kTpdo1Id + node, {Kind::node, NodeFrame::tpdo1, i});
    assign(kTpdo2Id + node, {Kind::node, NodeFrame::tpdo2, i});
    assign(kRpdo1Id + node, {Kind::master_request});
    assign(kSdoRequestId + node, {Kind::master_request});
  }
}

void CanopenNetwork::dispatch(const CanFrame& frame, RobotTime now) noexcept {
  if (!is_canopen(frame)) return;
  const Slot slot = slots_[frame.id];
  const char* other = "";
  switch (slot.kind) {
    case Kind::none: return;
    case Kind::node: return drives_[slot.drive]->receive(slot.what, frame, now);
    case Kind::nmt: other = "another master on the bus sends NMT commands"; break;
    case Kind::sync: other = "another master on the bus sends SYNC"; break;
    case Kind::own_heartbeat: other = "another node on the bus has the master's node id"; break;
    case Kind::master_request: other = "another master on the bus sends to our drives"; break;
  }
  if (*other_master_ == 0) other_master_ = other;
}

void CanopenNetwork::receive(RobotTime now) noexcept {
  constexpr int kMost = 4096;  // a flooded bus must not hold the loop
  for (int i = 0; i < kMost; ++i) {
    const auto frame = bus_.receive(Duration{0});
    if (!frame) break;
    dispatch(*frame, now);
  }
  for (const auto& drive : drives_) drive->check(now);
}

// Frames that do not leave are counted by the bus.
void CanopenNetwork::send(RobotTime now) noexcept {
  if (heartbeat_.due(now)) bus_.send(heartbeat_frame(NmtState::operational, config_.master_node));
  const bool permitted = healthy();
  for (const auto& drive : drives_)
    if (const auto frame = drive->command(permitted, now)) bus_.send(*frame);
  bus_.send(sync_frame());
}

void CanopenNetwork::pump(RobotTime until) {
  const RobotTime now = clock_.now();
  if (heartbeat_.due(now)) bus_.send(heartbeat_frame(NmtState::operational, config_.master_node));
  const RobotTime wake = std::min(until, heartbeat_.next());
  if (const auto frame = bus_.receive(std::max(wake - now, Duration{0}))) dispatch(*frame, clock_.now());
}

const char* CanopenNetwork::reason() const noexcept {
  if (*other_master_ != 0) return other_master_;
  switch (bus_.state()) {
    case CanBusState::bus_off: return "the CAN controller is bus-off";
    case CanBusState::down: return "the CAN interface is down";
    case CanBusState::active:
    case CanBusState::warning:
    case CanBusState::passive: break;
  }
  return "";
}

}  // namespace foresight::canopen

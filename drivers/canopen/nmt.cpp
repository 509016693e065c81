#include "drivers/canopen/nmt.hpp"

#include <algorithm>

#include "drivers/canopen/wire.hpp"

namespace foresight::canopen {

const char* to_string(NmtCommand command) {
  switch (command) {
    case NmtCommand::start: return "start";
    case NmtCommand::stop: return "stop";
    case NmtCommand::enter_pre_operational: return "enter pre-operational";
    case NmtCommand::reset_node: return "reset node";
    case NmtCommand::reset_communication: return "reset communication";
  }
  return "?";
}

const char* to_string(NmtState state) {
  switch (state) {
    case NmtState::boot_up: return "boot-up";
    case NmtState::stopped: return "stopped";
    case NmtState::operational: return "operational";
    case NmtState::pre_operational: return "pre-operational";
  }
  return "?";
}

CanFrame nmt_frame(NmtCommand command, int node) {
  CanFrame frame = data_frame(kNmtId, 2);
  frame.data[0] = static_cast<std::uint8_t>(command);
  frame.data[1] = static_cast<std::uint8_t>(node);
  return frame;
}

CanFrame heartbeat_frame(NmtState state, int node) {
  CanFrame frame = data_frame(kHeartbeatId + static_cast<std::uint32_t>(node), 1);
  frame.data[0] = static_cast<std::uint8_t>(state);
  return frame;
}

CanFrame sync_frame() {
  return data_frame(kSyncId, 0);
}

std::optional<Heartbeat> parse_heartbeat(const CanFrame& frame) noexcept {
  if (!is_canopen(frame) || frame.size != 1 || frame.id <= kHeartbeatId || frame.id > kHeartbeatId + kLargestNode)
    return std::nullopt;
  const auto state = static_cast<NmtState>(frame.data[0]);
  switch (state) {
    case NmtState::boot_up:
    case NmtState::stopped:
    case NmtState::operational:
    case NmtState::pre_operational: return Heartbeat{static_cast<int>(frame.id - kHeartbeatId), state};
  }
  return std::nullopt;
}

bool HeartbeatProducer::due(RobotTime now) noexcept {
  if (now < next_) return false;
  // A first call, or one after a pause, starts a new row of instants.
  next_ = next_ + period_ > now ? next_ + period_ : now + period_;
  return true;
}

void HeartbeatConsumer::heard(NmtState state, RobotTime at) noexcept {
  last_ = at;
  state_ = state;
}

std::optional<NmtState> HeartbeatConsumer::state(RobotTime now) const noexcept {
  return overdue(now) ? std::nullopt : state_;
}

bool HeartbeatConsumer::overdue(RobotTime now) const noexcept {
  return last_ && now - *last_ > timeout_;
}

}  // namespace foresight::canopen

// Network management (CiA 301, 7.2.8): commands to nodes, heartbeats from and to them. Pure.
#pragma once

#include <cstdint>
#include <optional>

#include "drivers/can/can_frame.hpp"

namespace foresight::canopen {

enum class NmtCommand : std::uint8_t {
  start = 0x01,
  stop = 0x02,
  enter_pre_operational = 0x80,
  reset_node = 0x81,
  reset_communication = 0x82,
};
/// "?" for a byte that is no command.
const char* to_string(NmtCommand command);

enum class NmtState : std::uint8_t { boot_up = 0x00, stopped = 0x04, operational = 0x05, pre_operational = 0x7f };
const char* to_string(NmtState state);

/// `node` 1 .. 127, or 0 for all.
CanFrame nmt_frame(NmtCommand command, int node);
CanFrame heartbeat_frame(NmtState state, int node);
CanFrame sync_frame();

struct Heartbeat {
  int node = 0;
  NmtState state = NmtState::boot_up;
};
/// Nothing where `frame` is no heartbeat or boot-up message (701h .. 77Fh, one byte that names a state).
/// The toggle bit of node guarding is no part of it.
std::optional<Heartbeat> parse_heartbeat(const CanFrame& frame) noexcept;

/// When the own heartbeat is due. `period` > 0; the first is due at once.
class HeartbeatProducer {
 public:
  explicit HeartbeatProducer(Duration period) : period_(period) {}
  /// True once a period; a late call does not make the next one late, nor are missed ones made up for.
  bool due(RobotTime now) noexcept;
  RobotTime next() const noexcept { return next_; }

 private:
  Duration period_;
  RobotTime next_;
};

/// Whether one node lives.
class HeartbeatConsumer {
 public:
  explicit HeartbeatConsumer(Duration timeout) : timeout_(timeout) {}
  /// `at`: when it was received, which may be well before it is read.
  void heard(NmtState state, RobotTime at) noexcept;
  /// The node was told to change its state: what it is in is known again once it says so.
  void forget_state() noexcept { state_.reset(); }
  /// Nothing while the node is overdue, or has not said it.
  std::optional<NmtState> state(RobotTime now) const noexcept;
  /// Silent for longer than the timeout; false where it was never heard.
  bool overdue(RobotTime now) const noexcept;

 private:
  Duration timeout_;
  std::optional<RobotTime> last_;
  std::optional<NmtState> state_;
};

}  // namespace foresight::canopen

// The operators that the robot knows: who they are, and their clocks.
#pragma once

#include <vector>

#include "link/control/messages.hpp"
#include "link/control/motion_permit.hpp"
#include "link/control/request_ledger.hpp"

namespace foresight {

/// One start of an operator's program.
struct DeskPeer {
  static constexpr Duration kAsksFor = std::chrono::seconds(10);  ///< after an Ask

  Nonce theirs = 0;  ///< its `from`
  Nonce ours = 0;  ///< what it must address; drawn when it came, so that a recording of an earlier one is known as such
  Identity identity;
  std::vector<Difference> differences;
  OperatorClockTracker clock;
  std::uint64_t jumps_seen = 0;  ///< of `clock`
  RobotTime heard;
  bool answered = false;      ///< has heard its Welcome: nobody may be there who hears that of a recorded Hello
  std::uint64_t asked = 0;    ///< number of its newest Ask
  std::uint64_t settled = 0;  ///< Asks up to this number have had their time: one that comes late is not followed
  RobotTime asked_at;         ///< when it last asked for control; 0: it does not
  RequestLedger requests;
  bool asks(RobotTime now) const { return asked_at.ns != 0 && now - asked_at <= kAsksFor; }
};

/// A few of them. One thread.
class DeskPeers {
 public:
  static constexpr std::size_t kMost = 8;
  static constexpr Duration kForgottenAfter = std::chrono::seconds(5);

  explicit DeskPeers(DrawNonce draw) : draw_(std::move(draw)) {}
  /// Who has said Hello, now or before. Where there are kMost, somebody goes: who never answered rather than who did,
  /// and of these who was not heard for longest, but never `kept` nor who asks for control; null where nobody else is
  /// left. One that is there after all says Hello again when the robot's answers stay away.
  DeskPeer* greet(Nonce theirs, const Identity& identity, const Identity& robot, RobotTime now, Nonce kept);
  /// Who sends from `theirs` to `ours`; null where this is nobody known.
  DeskPeer* find(Nonce theirs, Nonce ours);
  DeskPeer* find(Nonce theirs);
  /// Forgets who has not been heard for long, but never `kept`.
  void forget(RobotTime now, Nonce kept);
  std::vector<DeskPeer>& all() { return peers_; }

 private:
  bool make_room(RobotTime now, Nonce kept);

  DrawNonce draw_;
  std::vector<DeskPeer> peers_;
};

}  // namespace foresight

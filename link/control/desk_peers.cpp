#include "link/control/desk_peers.hpp"

#include <algorithm>
#include <utility>

namespace foresight {

DeskPeer* DeskPeers::find(Nonce theirs) {
  const auto found =
      std::find_if(peers_.begin(), peers_.end(), [theirs](const DeskPeer& p) { return p.theirs == theirs; });
  return found == peers_.end() ? nullptr : &*found;
}

DeskPeer* DeskPeers::find(Nonce theirs, Nonce ours) {
  DeskPeer* peer = find(theirs);
  return peer != nullptr && peer->ours == ours ? peer : nullptr;
}

/// Anybody may have an emergency stop to tell, so who comes is let in. Each new start of a seat's program leaves the
/// old one here for a while.
bool DeskPeers::make_room(RobotTime now, Nonce kept) {
  auto leaves = peers_.end();
  for (auto peer = peers_.begin(); peer != peers_.end(); ++peer) {
    if (peer->theirs == kept || peer->asks(now)) continue;
    const auto rank = [](const DeskPeer& p) { return std::pair(p.answered, p.heard); };
    if (leaves == peers_.end() || rank(*peer) < rank(*leaves)) leaves = peer;
  }
  if (leaves == peers_.end()) return false;
  peers_.erase(leaves);
  return true;
}

DeskPeer* DeskPeers::greet(Nonce theirs, const Identity& identity, const Identity& robot, RobotTime now, Nonce kept) {
  if (theirs == 0) return nullptr;
  if (DeskPeer* known = find(theirs)) return known;
  if (peers_.size() >= kMost && !make_room(now, kept)) return nullptr;
  DeskPeer peer;
  peer.theirs = theirs;
  peer.ours = draw_();
  peer.identity = bounded(identity);
  peer.differences = differences(robot, peer.identity);
  peer.clock = OperatorClockTracker(draw_());
  peer.heard = now;
  peers_.push_back(std::move(peer));
  return &peers_.back();
}

void DeskPeers::forget(RobotTime now, Nonce kept) {
  std::erase_if(peers_, [&](const DeskPeer& p) { return p.theirs != kept && now - p.heard > kForgottenAfter; });
}

}  // namespace foresight

#include "link/control/desk_peers.hpp"

#include <algorithm>

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

DeskPeer* DeskPeers::greet(Nonce theirs, const Identity& identity, const Identity& robot, RobotTime now) {
  if (theirs == 0) return nullptr;
  if (DeskPeer* known = find(theirs)) return known;
  if (peers_.size() >= kMost) return nullptr;
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

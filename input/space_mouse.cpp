#include "input/space_mouse.hpp"

#include <spnav.h>
#include <sys/socket.h>

#include <cerrno>

namespace foresight {
namespace {

constexpr int kMostEvents = 1000;  // in one round: whoever floods us does not keep us

bool daemon_gone() noexcept {
  char byte = 0;
  const ssize_t got = ::recv(spnav_fd(), &byte, 1, MSG_PEEK | MSG_DONTWAIT);
  return got == 0 || (got < 0 && errno != EAGAIN && errno != EWOULDBLOCK && errno != EINTR);
}

bool anything_there() noexcept {
  // A whole event: the library waits for the rest of a part.
  int words[8];
  return ::recv(spnav_fd(), words, sizeof words, MSG_PEEK | MSG_DONTWAIT) == static_cast<ssize_t>(sizeof words);
}

}  // namespace

SpaceMouse::SpaceMouse(const SpaceMouseOptions& options) : options_(options), hand_(options.hand) {
  open_ = spnav_open() == 0;
}

SpaceMouse::~SpaceMouse() {
  if (open_) spnav_close();
}

std::vector<std::pair<std::string, std::string>> SpaceMouse::keys() {
  return {{"cap", "of the 6-DOF device: the tool goes and turns along"},
          {"button 1", "held: the robot moves"},
          {"button 2", "gripper closes, the next time opens"},
          {"buttons 3, 4", "the view as it began; recentre"}};
}

void SpaceMouse::look_for_daemon(OperatorTime now) noexcept {
  if (open_ && daemon_gone()) {
    spnav_close();
    open_ = false;
    tried_ = now;
  }
  if (open_) return;
  plugged(true);
  if (!tried_) tried_ = now;
  if (now - *tried_ < options_.try_again) return;
  tried_ = now;
  open_ = spnav_open() == 0;
}

void SpaceMouse::button(int number, bool down) noexcept {
  switch (number) {
    case 0:
      buttons_.set(TrackerButton::deadman, down);
      buttons_.set(TrackerButton::clutch, down);
      break;
    case 1:
      if (down) buttons_.set(closes_next_ ? TrackerButton::gripper_close : TrackerButton::gripper_open);
      if (down) closes_next_ = !closes_next_;
      if (!down) buttons_.set(TrackerButton::gripper_close, false);
      if (!down) buttons_.set(TrackerButton::gripper_open, false);
      break;
    case 2: buttons_.set(TrackerButton::home_view, down); break;
    case 3: buttons_.set(TrackerButton::recentre, down); break;
    default: break;
  }
}

void SpaceMouse::plugged(bool there) noexcept {
  unplugged_ = !there;
  rate_ = {};
  buttons_ = {};
}

// spacenavd says x to the right, y up and z forward, which is left-handed: turning about x and y has its sign changed.
void SpaceMouse::take_events(OperatorTime now) noexcept {
  spnav_event event{};
  const auto share = [this](int value) { return without_dead_zone(value / options_.full_scale, options_.dead_zone); };
  for (int i = 0; i < kMostEvents && anything_there(); ++i) {
    const int type = spnav_poll_event(&event);
    if (type == SPNAV_EVENT_BUTTON) button(event.button.bnum, event.button.press != 0);
    if (type == SPNAV_EVENT_DEV) plugged(event.dev.op == SPNAV_DEV_ADD);
    if (type != SPNAV_EVENT_MOTION) continue;
    const spnav_event_motion& m = event.motion;
    rate_.linear << share(m.z), share(m.x) * -1, share(m.y);
    rate_.angular << share(m.rz) * -1, share(m.rx), share(m.ry) * -1;
    moved_ = now;
    unplugged_ = false;
  }
}

TrackerState SpaceMouse::read(OperatorTime now) noexcept {
  if (open_) take_events(now);
  look_for_daemon(now);
  if (!moved_ || now - *moved_ > options_.stale_after) rate_ = {};
  TrackerState out;
  out.time = now;
  out.integrated = true;
  out.T_space_hand = hand_.step(now, rate_);
  if (!open_ || unplugged_) {
    out.trouble = open_ ? "the 6-DOF device was unplugged" : "spacenavd does not answer";
    out.cure = open_ ? "plug it in; let go of its button, and press it again"
                     : "plug the 6-DOF device in and start its daemon: systemctl start spacenavd";
    return out;
  }
  out.connected = out.tracked = true;
  out.buttons = buttons_;
  return out;
}

}  // namespace foresight

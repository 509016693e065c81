#include "input/any_tracker.hpp"

#include <algorithm>
#include <array>

#include "input/hand_watch.hpp"

namespace foresight {
namespace {

constexpr std::array kOfAll{TrackerButton::home_view, TrackerButton::recentre, TrackerButton::joint_mode,
                            TrackerButton::next_joint, TrackerButton::previous_joint};

bool held(const TrackerState& state) noexcept {
  return state.connected && state.buttons.held(TrackerButton::deadman);
}

bool there(const TrackerState& state) noexcept {
  return state.connected && !state.stands_in;
}

}  // namespace

void AnyTracker::watch(Device& device, OperatorTime now) noexcept {
  const TrackerState& state = device.state;
  if (!state.connected || !state.tracked || state.integrated) return device.pose.reset();
  if (device.pose && device.pose->matrix() == state.T_space_hand.matrix()) return;
  device.pose = state.T_space_hand;
  device.stirred = now;
}

// Compared, not subtracted: an instant of another clock may be any number.
bool AnyTracker::is_silent(const Device& device, OperatorTime now) noexcept {
  return device.state.connected && device.state.time < now - HandWatchOptions{}.frozen_after;
}

bool AnyTracker::is_frozen(const Device& device, OperatorTime now) noexcept {
  return is_silent(device, now) || (device.state.connected && device.pose && device.stirred < now - kStill);
}

// Whose switch was just pressed.
bool AnyTracker::take_charge() noexcept {
  const auto pressed =
      std::ranges::find_if(devices_, [](const Device& device) { return device.open && held(device.state); });
  if (pressed == devices_.end()) return false;
  shown_ = static_cast<std::size_t>(pressed - devices_.begin());
  return true;
}

void AnyTracker::heed_loss() noexcept {
  const TrackerState& driving = devices_[shown_].state;
  if (in_charge_ && !driving.connected) lost_ = shown_;
  if (lost_ && there(devices_[*lost_].state)) lost_.reset();
}

std::vector<AnyTracker::Missing> AnyTracker::missing() const {
  std::vector<Missing> out;
  for (std::size_t i = 0; was_read_ && i < devices_.size(); ++i) {
    const Device& device = devices_[i];
    if (!there(device.state)) out.push_back({device.tracker, lost_ == i, device.state.trouble, device.state.cure});
  }
  return out;
}

template <typename SaysMore>
void AnyTracker::show_instead(SaysMore says_more) noexcept {
  if (says_more(devices_[shown_])) return;
  const auto other = std::ranges::find_if(devices_, says_more);
  if (other != devices_.end()) shown_ = static_cast<std::size_t>(other - devices_.begin());
}

TrackerState AnyTracker::read(OperatorTime now) noexcept {
  for (Device& device : devices_) {
    device.state = device.tracker->read(now);
    watch(device, now);
  }
  was_read_ = true;
  heed_loss();
  const bool was = in_charge_;
  const std::size_t before = shown_;
  const bool goes_on = was && held(devices_[shown_].state);
  if (goes_on && is_frozen(devices_[shown_], now)) take_charge();
  in_charge_ = was ? goes_on : take_charge();
  if (!was && in_charge_) lost_.reset();
  // Where nobody drives, one that is there says more than one that is not, and one that speaks more than one that is
  // frozen. One that has just gone ends the motion.
  if (!was && !in_charge_) {
    show_instead([](const Device& device) { return device.state.connected; });
    show_instead([now](const Device& device) { return device.state.connected && !is_silent(device, now); });
  }
  TrackerState out = devices_[shown_].state;
  // Its pose has nothing to do with that of the one before: it comes with an open switch first.
  if (!in_charge_ || shown_ != before) out.buttons.set(TrackerButton::deadman, false);
  if (lost_ && *lost_ != shown_) {
    out.stands_in = true;
    out.trouble = devices_[*lost_].state.trouble;
    out.cure = devices_[*lost_].state.cure;
  }
  for (Device& device : devices_) {
    device.open = device.state.connected && !held(device.state);
    if (!device.state.connected || is_silent(device, now)) continue;
    for (const TrackerButton button : kOfAll)
      if (device.state.buttons.held(button)) out.buttons.set(button);
    if (device.state.joint) out.joint = device.state.joint;
    if (out.pan_rate == 0) out.pan_rate = device.state.pan_rate;
    if (out.tilt_rate == 0) out.tilt_rate = device.state.tilt_rate;
  }
  return out;
}

}  // namespace foresight

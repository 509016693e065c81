#include "input/any_tracker.hpp"

#include <algorithm>
#include <array>

namespace foresight {
namespace {

constexpr std::array kOfAll{TrackerButton::home_view, TrackerButton::recentre, TrackerButton::joint_mode,
                            TrackerButton::next_joint, TrackerButton::previous_joint};

bool held(const TrackerState& state) noexcept {
  return state.connected && state.buttons.held(TrackerButton::deadman);
}

}  // namespace

// Whose switch was just pressed.
bool AnyTracker::take_charge() noexcept {
  const auto pressed =
      std::ranges::find_if(devices_, [](const Device& device) { return device.open && held(device.state); });
  if (pressed == devices_.end()) return false;
  shown_ = static_cast<std::size_t>(pressed - devices_.begin());
  return true;
}

TrackerState AnyTracker::read(OperatorTime now) noexcept {
  for (Device& device : devices_) device.state = device.tracker->read(now);
  const bool was = in_charge_;
  const std::size_t before = shown_;
  in_charge_ = was ? held(devices_[shown_].state) : take_charge();
  // Where nobody drives, one that is there says more than one that is not; one that has just gone has to be said.
  if (!was && !in_charge_ && !devices_[shown_].state.connected) {
    const auto there = std::ranges::find_if(devices_, [](const Device& device) { return device.state.connected; });
    if (there != devices_.end()) shown_ = static_cast<std::size_t>(there - devices_.begin());
  }
  TrackerState out = devices_[shown_].state;
  // Its pose has nothing to do with that of the one before: it comes with an open switch first.
  if (!in_charge_ || shown_ != before) out.buttons.set(TrackerButton::deadman, false);
  for (Device& device : devices_) {
    device.open = device.state.connected && !held(device.state);
    if (!device.state.connected) continue;
    for (const TrackerButton button : kOfAll)
      if (device.state.buttons.held(button)) out.buttons.set(button);
    if (device.state.joint) out.joint = device.state.joint;
    if (out.pan_rate == 0) out.pan_rate = device.state.pan_rate;
    if (out.tilt_rate == 0) out.tilt_rate = device.state.tilt_rate;
  }
  return out;
}

}  // namespace foresight

// Several devices on one table: whichever switch is pressed first is in charge until it is let go of.
#pragma once

#include <optional>
#include <vector>

#include "input/tracker.hpp"

namespace foresight {

/// Only who presses a switch while nobody is in charge takes over: not one who held it before, nor a device that comes
/// with its switch held. One that goes while it is in charge has gone; another takes another press. From one that says
/// nothing new (HandWatchOptions::frozen_after), or whose tracked hand does not stir by a single bit (kStill), with its
/// switch held, another one's press takes over; it then has to let go, as one that held its switch before. Views,
/// recentring, single joints and the camera listen to all of them that still speak. One thread.
///
/// Where another one stands in for one that went while it was in charge, what is read counts, and has the trouble and
/// cure of the one that went, until that is back or another switch is pressed (TrackerState::stands_in).
class AnyTracker final : public Tracker {
 public:
  /// A hand trembles, and trackers are noisy: nobody holds one so still for so long.
  static constexpr Duration kStill = std::chrono::milliseconds(1000);

  /// At least one; they outlive this.
  explicit AnyTracker(std::vector<Tracker*> devices) : devices_(devices.begin(), devices.end()) {}

  /// Of the one in charge, or that was last.
  std::string name() const override { return devices_[shown_].tracker->name(); }
  TrackerState read(OperatorTime now) noexcept override;
  /// Whose switch is held; null: nobody's.
  const Tracker* in_charge() const noexcept { return in_charge_ ? devices_[shown_].tracker : nullptr; }

  struct Missing {
    const Tracker* device;
    bool drove;           ///< it went while it was in charge, and no other switch has been pressed since
    const char* trouble;  ///< TrackerState's
    const char* cure;
  };
  /// Those that were not there at the last read().
  std::vector<Missing> missing() const;

 private:
  struct Device {
    explicit Device(Tracker* device) : tracker(device) {}
    Tracker* tracker;
    TrackerState state;
    bool open = false;         // was there with its switch open when it was read before
    std::optional<Pose> pose;  // of the tracked hand, which has been there since `stirred`
    OperatorTime stirred;
  };
  static void watch(Device& device, OperatorTime now) noexcept;
  static bool is_silent(const Device& device, OperatorTime now) noexcept;
  static bool is_frozen(const Device& device, OperatorTime now) noexcept;
  bool take_charge() noexcept;
  /// Another device, where the one shown does not say so much.
  template <typename SaysMore>
  void show_instead(SaysMore says_more) noexcept;
  void heed_loss() noexcept;

  std::vector<Device> devices_;
  std::size_t shown_ = 0;
  bool in_charge_ = false, was_read_ = false;
  std::optional<std::size_t> lost_;  // went while it was in charge
};

}  // namespace foresight

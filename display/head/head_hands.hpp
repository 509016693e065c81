// Tracked controllers as devices in the operator's hands.
//
//   squeeze  switch and clutch      trigger  gripper      stick  the camera
//   stick pressed  recentre         A, X or the menu button  the view as it began
#pragma once

#include <array>
#include <memory>
#include <mutex>

#include "input/any_tracker.hpp"

namespace foresight::head {

/// What one controller says, from the head display's thread to the seat's. It lasts while runtimes come and go. Any
/// thread; holds its lock for a copy.
class HeldController {
 public:
  void say(const TrackerState& state) noexcept;
  TrackerState heard() const noexcept;

 private:
  mutable std::mutex mutex_;
  TrackerState state_;
};

/// Left and right.
struct HeldControllers {
  HeldControllers();
  std::array<HeldController, 2> hands;
  /// Neither counts, for this reason; static text.
  void gone(const char* trouble, const char* cure) noexcept;
};

/// Both as one device: whichever switch is pressed first is in charge. What a head display does not renew grows old,
/// and counts for nothing then (HandWatch).
class HeadHands final : public Tracker {
 public:
  explicit HeadHands(std::shared_ptr<const HeldControllers> held);
  std::string name() const override { return any_.name(); }
  TrackerState read(OperatorTime now) noexcept override { return any_.read(now); }

 private:
  class One final : public Tracker {
   public:
    One(const HeldController& held, const char* name) : held_(held), name_(name) {}
    std::string name() const override { return name_; }
    TrackerState read(OperatorTime /*now*/) noexcept override { return held_.heard(); }

   private:
    const HeldController& held_;
    const char* name_;
  };
  std::shared_ptr<const HeldControllers> held_;
  std::array<One, 2> hands_;
  AnyTracker any_;
};

}  // namespace foresight::head

// The controllers of an OpenXR session: actions, bindings, poses.
#pragma once

#include <array>
#include <optional>

#include "display/head/head_hands.hpp"
#include "display/head/xr_calls.hpp"

namespace foresight::head {

/// Belongs to the session; goes before it.
class Controllers {
 public:
  /// Suggests bindings for the controllers that the runtime knows, and attaches. Throws CallFailed.
  Controllers(XrInstance instance, XrSession session);
  ~Controllers();
  Controllers(const Controllers&) = delete;
  Controllers& operator=(const Controllers&) = delete;

  struct Now {
    OperatorTime time;               ///< that states are stamped with
    XrTime display_time = 0;         ///< of the frame that was waited for: where hands will be then
    XrSpace space = XR_NULL_HANDLE;  ///< that poses are given in
    std::optional<Pose> T_space_head;
    bool focused = false;     ///< controllers are ours
    bool poses_count = true;  ///< false: space or time have jumped
  };
  /// Asks for all of both, once a frame. Throws CallFailed.
  void update(const Now& now, HeldControllers& out);

 private:
  struct Hand {
    XrPath path = XR_NULL_PATH;
    XrSpace space = XR_NULL_HANDLE;
    bool held = false;  // the squeeze, with hysteresis
  };
  XrAction make(XrActionType type, const char* name, const char* shown);
  void suggest() const;
  TrackerState state_of(Hand& hand, const Now& now);
  /// Nothing: the headset does not see it.
  std::optional<Pose> seen_at(const Hand& hand, const Now& now) const;
  Eigen::Vector2d stick_of(const Hand& hand) const;
  bool pressed(XrAction action, const Hand& hand) const;
  std::optional<double> value(XrAction action, const Hand& hand) const;

  XrInstance instance_;
  XrSession session_;
  XrActionSet set_ = XR_NULL_HANDLE;
  XrAction grip_ = XR_NULL_HANDLE, squeeze_ = XR_NULL_HANDLE, trigger_ = XR_NULL_HANDLE, stick_ = XR_NULL_HANDLE,
           recentre_ = XR_NULL_HANDLE, home_ = XR_NULL_HANDLE;
  std::array<Hand, 2> hands_;
};

/// Whether a squeeze of so much (0 .. 1) is the switch held, if it was or was not before: a hand that hovers at the
/// threshold does not let go and press in turns. What is no number lets go.
bool squeezed(double squeeze, bool was) noexcept;

}  // namespace foresight::head

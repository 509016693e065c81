// What a device in the operator's hand says: a keyboard and mouse, a gamepad, a 6-DOF device, a tracked controller, a
// recording of one.
//
//   device --> Tracker::read(now) --> TrackerState --> HandControl (hand_control.hpp) --> set-points
//
// Space is where the operator is: x forward, y left, z up, in metres, its origin anywhere. The hand's own axes are
// alike: x where it points, y to its left, z up.
#pragma once

#include <bitset>
#include <memory>
#include <optional>
#include <string>

#include "common/time.hpp"
#include "scene/scene_model.hpp"

namespace foresight {

enum class TrackerButton : std::uint8_t {
  deadman,        ///< held, or nothing moves
  clutch,         ///< held, the tool goes with the hand; released, the hand goes alone
  gripper_open,   ///< held, the gripper opens
  gripper_close,  ///< held, it closes
  home_view,      ///< the view goes back to where it began
  recentre,       ///< forward is where the operator (or, where that is not known, the hand) points now
  joint_mode,     ///< each press changes between moving the tool and moving one joint
  next_joint,
  previous_joint,
  to_start,  ///< held, the joints go to the start position
};
inline constexpr std::size_t kTrackerButtons = 10;
const char* to_string(TrackerButton button) noexcept;

/// Which buttons are held.
class TrackerButtons {
 public:
  bool held(TrackerButton button) const noexcept { return bits_[static_cast<std::size_t>(button)]; }
  void set(TrackerButton button, bool held = true) noexcept { bits_[static_cast<std::size_t>(button)] = held; }
  friend bool operator==(const TrackerButtons&, const TrackerButtons&) = default;

 private:
  std::bitset<kTrackerButtons> bits_;
};

/// The newest that a device has said. A plain value.
struct TrackerState {
  bool connected = false;  ///< buttons and axes count
  bool tracked = false;    ///< the pose counts
  /// Another device went while it drove, for which this one stands in (AnyTracker): trouble and cure are of that one.
  bool stands_in = false;
  /// What keeps either from counting, and what to do; "" where nothing does. Static text.
  const char* trouble = "";
  const char* cure = "";
  /// When all this was captured. Of a device that has gone silent, it stays behind.
  OperatorTime time;
  /// The pose was made of speeds (keys, sticks): it has no noise, and means nothing but its changes.
  bool integrated = false;
  Pose T_space_hand = Pose::Identity();
  std::optional<Pose> T_space_head;  ///< of a device that tracks the head, too: x where it looks, z up
  TrackerButtons buttons;
  std::optional<double> grip;        ///< 0 open .. 1 closed, of a trigger; buttons open and close otherwise
  std::optional<std::size_t> joint;  ///< was chosen by its number, counted from 0
  double joint_rate = 0;             ///< -1 .. 1 of a joint's jogging speed, for joint mode
  double pan_rate = 0;               ///< -1 .. 1, the camera: left is positive
  double tilt_rate = 0;              ///< -1 .. 1, up is positive
};

/// One device. One thread.
class Tracker {
 public:
  virtual ~Tracker() = default;
  /// "gamepad 'Wireless Controller'", for people.
  virtual std::string name() const = 0;
  /// What it says now; `now` never goes back. Neither throws nor waits for the device. A device that is not there, or
  /// no longer, says so (`connected` is false) from the next call on, and is found again when it comes back.
  virtual TrackerState read(OperatorTime now) noexcept = 0;
};

}  // namespace foresight

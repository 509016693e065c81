// A keyboard and a mouse as a hand. The events are a window's, given as plain values.
//
//   hold left shift (or the left mouse button): the deadman switch and the clutch
//   W A S D R F  forward, left, back, right, up, down        I K J L U O  tip down and up, turn left and right, roll
//   mouse        with its left button: right and up; with the right one, too: turn; wheel: forward, back
//   C V  gripper close, open      Home  the view as it began      N  recentre      M  move single joints
//   1 .. 9, 0  the joint          - =  move it         left control  a fifth of the speed      arrows  the camera
#pragma once

#include <array>
#include <span>
#include <vector>

#include "input/rate_hand.hpp"
#include "input/tracker.hpp"

namespace foresight {

enum class HandKey : std::uint8_t {
  forward,
  back,
  left,
  right,
  up,
  down,
  pitch_down,
  pitch_up,
  yaw_left,
  yaw_right,
  roll_left,
  roll_right,
  pan_left,
  pan_right,
  tilt_up,
  tilt_down,
  deadman,
  slow,
  gripper_close,
  gripper_open,
  home_view,
  recentre,
  joint_mode,
  joint_less,
  joint_more,
  to_start,
  joint_1,
  joint_2,
  joint_3,
  joint_4,
  joint_5,
  joint_6,
  joint_7,
  joint_8,
  joint_9,
  joint_10,
};
inline constexpr std::size_t kHandKeys = 36;

struct KeyBinding {
  HandKey key;
  int code;  ///< of the key in a GLFW window (GLFW_KEY_W): its place on the keyboard, whatever is printed there
  const char* printed;  ///< "W", "left shift", of the US layout
  const char* does;     ///< "forward", for a list of all keys
};
/// All of them, in the order of HandKey.
std::span<const KeyBinding> key_bindings() noexcept;
/// Nothing for a key that does nothing here.
std::optional<HandKey> hand_key(int glfw_code) noexcept;

struct KeyboardMouseOptions {
  RateHandOptions hand;
  double metres_per_px = 0.0005;
  double rad_per_px = 0.003;
  double metres_per_notch = 0.005;  ///< of the wheel
  double slow = 0.2;                ///< share of all speeds with the slow key
  /// A window that has not looked for events for longer says nothing: all keys count as released.
  Duration window_answers_within = std::chrono::milliseconds(250);
};

/// One thread, the window's. Events count from the next read() on. A switch that was let go of and pressed again
/// between two of them, as while a picture is drawn, was let go of all the same: the first read() says so.
class KeyboardMouse final : public Tracker {
 public:
  explicit KeyboardMouse(const KeyboardMouseOptions& options = {}) noexcept : options_(options), hand_(options.hand) {}

  void key(HandKey key, bool down) noexcept;
  enum class MouseButton : std::uint8_t { left, right };
  /// As it is now, as often as one likes: what no longer counts does so again once it was let go of and pressed.
  void mouse_button(MouseButton button, bool down) noexcept;
  /// The pointer went so far, px: to the right, downwards.
  void mouse_moved(double right_px, double down_px) noexcept;
  /// Away from the operator is positive.
  void wheel(double notches) noexcept;
  /// The window lost the keyboard (or closed): all is released. What is held when it comes back must be pressed again.
  void focus_lost() noexcept;
  /// The window has looked for events. At each of its rounds, or keys do not count.
  void looked(OperatorTime now) noexcept;
  /// How long the window did not look while a switch was held that did not count any more because of that: as long as
  /// it is held on, and for kToldFor at least; nothing where no switch was held in vain.
  std::optional<Duration> held_in_vain(OperatorTime now) const noexcept;
  static constexpr Duration kToldFor = std::chrono::seconds(4);
  /// A switch is held that does not count, as the window did not look: it has to be let go of.
  bool has_to_let_go() const noexcept { return is_in_vain_; }

  std::string name() const override { return "keyboard and mouse"; }
  TrackerState read(OperatorTime now) noexcept override;

 private:
  bool down(HandKey key) const noexcept { return down_[static_cast<std::size_t>(key)]; }
  bool take_tap(HandKey key) noexcept;
  void change(bool& is_down, bool down) noexcept;
  void release_all() noexcept;
  bool held() const noexcept { return down(HandKey::deadman) || mouse_[0]; }
  double way(HandKey more, HandKey less) const noexcept;
  HandRate rate_of_keys() const noexcept;
  HandRate take_mouse(double seconds) noexcept;

  KeyboardMouseOptions options_;
  RateHand hand_;
  std::array<bool, kHandKeys> down_{}, tapped_{};  // now; since the last read(), if only for a moment
  std::array<bool, 2> mouse_{}, mouse_told_{};     // what counts; what the window said last
  bool let_go_ = false;                            // since the last read()
  Eigen::Vector3d way_{0, 0, 0}, turn_{0, 0, 0};   // of the mouse, not gone yet: m, rad
  std::optional<OperatorTime> looked_, read_;
  struct LateLook {
    OperatorTime at;
    Duration after;
  };
  std::optional<LateLook> late_;
  bool was_in_vain_ = false;  // since the window looked
  bool is_in_vain_ = false;   // has_to_let_go()
  std::optional<std::size_t> joint_;
};

}  // namespace foresight

// A gamepad, or what SDL takes for one, as a hand.
//
//   right shoulder  the deadman switch and the clutch        left shoulder, held: the sticks turn instead
//   left stick      forward, back, left, right               right stick  up, down; turn left, right
//   with the left shoulder: left stick  tip, roll            triggers     right closes the gripper, left opens it
//   X  single joints    B  the view as it began    Y  recentre    cross  the camera; which joint, where single ones
//   move
#pragma once

#include <array>
#include <string>
#include <utility>
#include <vector>

#include "input/force.hpp"
#include "input/rate_hand.hpp"

namespace foresight {

struct GamepadOptions {
  RateHandOptions hand;
  double dead_zone = 0.15;  ///< of a stick, of its way
  double trigger = 0.5;     ///< of its way, from where it counts as pressed
  /// Where nothing of the pad changes by the smallest step for so long, sticks, triggers and cross count as let go of
  /// until something does: a wireless pad that went out of range is only noticed seconds later.
  Duration stale_after = std::chrono::seconds(2);
};

/// What is plugged in.
struct GamepadFound {
  int index = 0;  ///< for Gamepad()
  std::string name;
  bool known = true;  ///< SDL knows which button is which
};
/// Throws RuntimeFailure where SDL cannot be used.
std::vector<GamepadFound> find_gamepads();

/// Unplugged, it has gone with the next read(); plugged in again (or another one), it is there again, with all buttons
/// to be let go of first. SDL is the whole process's: one thread for all gamepads.
class Gamepad final : public Tracker, public ForceSink {
 public:
  /// The `index`-th one; it may come later. Throws RuntimeFailure where SDL cannot be used.
  explicit Gamepad(std::size_t index = 0, const GamepadOptions& options = {});
  ~Gamepad() override;
  Gamepad(const Gamepad&) = delete;
  Gamepad& operator=(const Gamepad&) = delete;

  /// Of all gamepads: each button, and what it does.
  static std::vector<std::pair<std::string, std::string>> keys();
  std::string name() const override;
  TrackerState read(OperatorTime now) noexcept override;
  /// By its motors, where it has some.
  void push(OperatorTime now, const HandContact& contact) noexcept override;

 private:
  struct Device;
  struct State {  // raw
    std::array<int, 6> axes;
    std::array<bool, 21> buttons;
    bool operator==(const State&) const = default;
  };
  bool is_stale(OperatorTime now) noexcept;
  std::unique_ptr<Device> device_;
  GamepadOptions options_;
  RateHand hand_;
  State last_{};
  std::optional<OperatorTime> changed_;
};

}  // namespace foresight

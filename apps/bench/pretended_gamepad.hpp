// A gamepad that SDL pretends, for the product's own Gamepad to find.
#pragma once

#include <memory>

#include "input/tracker.hpp"

namespace foresight {

/// Sticks and buttons, -1 .. 1, as SDL says them: y down.
struct PadSticks {
  double left_x = 0, left_y = 0, right_x = 0, right_y = 0;
  bool right_shoulder = false;
};

/// One thread, that of all gamepads.
class PretendedGamepad {
 public:
  /// Plugged in. Throws RuntimeFailure where SDL cannot be used.
  PretendedGamepad();
  ~PretendedGamepad();
  PretendedGamepad(const PretendedGamepad&) = delete;
  PretendedGamepad& operator=(const PretendedGamepad&) = delete;

  void plug(bool in);
  void move(const PadSticks& sticks);
  /// For Gamepad(): real ones may come before it.
  std::size_t index() const { return index_; }

 private:
  struct Pad;
  std::shared_ptr<void> sdl_;
  std::unique_ptr<Pad> pad_;  // while it is plugged in
  std::size_t index_ = 0;
};

}  // namespace foresight

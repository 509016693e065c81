// Keys of the seat's window, beside those of the hand (key_bindings(), input/keyboard_mouse.hpp).
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "seat/hand_driver.hpp"

namespace foresight {

enum class SeatKey : std::uint8_t {
  stop,  // by gl::Window::take_space()
  end,   // by gl::WindowInput::asked_to_end, as Escape
  enable,
  home,
  reset,
  set_up,
  control,
  hand_over,
  main_view,
  stereo,
  swap_eyes,
  stereogram,
  stereogram_depth,
  stereogram_pattern,
  stereogram_variant,
  beside,
  paint,
  marks,
  help,
  sounds,
  screenshot,
};

struct SeatKeyBinding {
  SeatKey key;
  int code;             ///< KeyBinding::code
  const char* printed;  ///< KeyBinding::printed
};
/// All of them, in the order of SeatKey. No code is one of key_bindings(), too.
std::span<const SeatKeyBinding> seat_keys() noexcept;
const char* printed(SeatKey key) noexcept;  ///< SeatKeyBinding::printed
/// Nothing for a key that does nothing here.
std::optional<SeatKey> seat_key(int glfw_code) noexcept;

/// For the display: each key, the hand's too, and what it does. A small window shows the first ones first: what
/// stops and drives the robot. `device`: likewise, of the device that is used beside keyboard and mouse (keys_of(),
/// input/open_tracker.hpp). Keys that drive what the rig has not are left out.
std::vector<std::pair<std::string, std::string>> key_words(
    const std::vector<std::pair<std::string, std::string>>& device = {}, const DrivenParts& parts = {});

}  // namespace foresight

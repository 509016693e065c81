// Single key presses from a terminal.
#pragma once

#include <termios.h>

#include <string>

#include "apps/robot/terminal_keys.hpp"

namespace foresight {

/// Takes the terminal's line editing away for its life, if stdin is a terminal. One thread.
class Keyboard {
 public:
  Keyboard();
  ~Keyboard();
  Keyboard(const Keyboard&) = delete;
  Keyboard& operator=(const Keyboard&) = delete;
  bool is_terminal() const { return is_terminal_; }
  /// What was typed since the last call, as TerminalKeys has it; does not wait.
  std::string pressed();

 private:
  bool is_terminal_ = false;
  termios before_{};
  TerminalKeys keys_;
};

}  // namespace foresight

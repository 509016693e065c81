// Which keys a terminal's bytes are.
#pragma once

#include <string>
#include <string_view>

namespace foresight {

/// Arrow keys come as '+' (up, right) and '-' (down, left). All else that a terminal sends as an escape sequence
/// (ECMA-48, 5.4; Delete, F keys, a key with Alt) is no key: its digits and letters are not what somebody pressed. A
/// space is one wherever it comes: it stops the robot, and no key's sequence has one. One thread.
class TerminalKeys {
 public:
  /// Of what came since the last call; sequences may be cut anywhere. An Escape after which nothing has come is over
  /// with the next call.
  std::string of(std::string_view bytes);

 private:
  enum class Within { nothing, escape, control_sequence, single_shift };
  /// The key that a byte completes; 0: none.
  char take(char byte);

  Within within_ = Within::nothing;
  bool has_parameters_ = false;  // of a control sequence
};

}  // namespace foresight

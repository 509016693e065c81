#include "apps/robot/keyboard.hpp"

#include <poll.h>
#include <unistd.h>

namespace foresight {

Keyboard::Keyboard() {
  is_terminal_ = isatty(STDIN_FILENO) == 1 && tcgetattr(STDIN_FILENO, &before_) == 0;
  if (!is_terminal_) return;
  termios raw = before_;
  raw.c_lflag &= ~static_cast<tcflag_t>(ICANON | ECHO);
  tcsetattr(STDIN_FILENO, TCSANOW, &raw);
}

Keyboard::~Keyboard() {
  if (is_terminal_) tcsetattr(STDIN_FILENO, TCSANOW, &before_);
}

std::string Keyboard::pressed() {
  std::string typed;
  pollfd input{STDIN_FILENO, POLLIN, 0};
  char bytes[64];
  while (is_terminal_ && poll(&input, 1, 0) == 1 && (input.revents & POLLIN) != 0) {
    const auto count = read(STDIN_FILENO, bytes, sizeof bytes);
    if (count <= 0) break;
    typed.append(bytes, static_cast<std::size_t>(count));
  }
  return keys_.of(typed);
}

}  // namespace foresight

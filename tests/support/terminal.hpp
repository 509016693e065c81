// A terminal that a program under test sits at.
#pragma once

#include <fcntl.h>
#include <poll.h>
#include <stdlib.h>
#include <termios.h>
#include <unistd.h>

#include <array>
#include <stdexcept>
#include <string>

#include "common/unique_fd.hpp"

namespace foresight {

/// Our end of a pseudo terminal (pty(7)). One thread.
class Terminal {
 public:
  /// Throws std::runtime_error where there are none.
  Terminal() : end_(posix_openpt(O_RDWR | O_NOCTTY)) {
    if (!end_ || grantpt(end_.get()) != 0 || unlockpt(end_.get()) != 0) throw std::runtime_error("no pseudo terminal");
    name_ = ptsname(end_.get());
    other_ = UniqueFd(open(name_.c_str(), O_RDWR | O_NOCTTY));  // else reading fails until a program has opened it
  }

  /// Its modes at present.
  termios modes() const {
    termios out{};
    tcgetattr(other_.get(), &out);
    return out;
  }
  /// For a shell: the program's streams are this terminal.
  std::string redirection() const { return "exec <>" + name_ + " >&0 2>&0"; }
  void type(const std::string& keys) {
    [[maybe_unused]] const auto typed = write(end_.get(), keys.data(), keys.size());
  }
  /// What has come since; waits until something does, a second at most.
  std::string shown() {
    std::array<char, 4096> bytes;
    pollfd input{end_.get(), POLLIN, 0};
    if (poll(&input, 1, 1000) != 1) return "";
    const ssize_t count = read(end_.get(), bytes.data(), bytes.size());
    return count > 0 ? std::string(bytes.data(), static_cast<std::size_t>(count)) : "";
  }

 private:
  UniqueFd end_, other_;
  std::string name_;
};

}  // namespace foresight

// Another program, for tests of what goes between two.
#pragma once

#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <cstdio>
#include <functional>

#include "tests/support/patience.hpp"

namespace foresight {

/// A process that runs `body` until it returns or this ends. To be made while this process has one thread.
class Child {
 public:
  explicit Child(const std::function<void()>& body) {
    std::fflush(nullptr);
    pid_ = ::fork();
    if (pid_ != 0) return;
    ::prctl(PR_SET_PDEATHSIG, SIGKILL);
    body();
    ::_exit(0);
  }
  ~Child() {
    ::kill(pid_, SIGKILL);
    ::waitpid(pid_, nullptr, 0);
  }
  Child(const Child&) = delete;

  void pause() const {
    ::kill(pid_, SIGSTOP);
    ::waitpid(pid_, nullptr, WUNTRACED);
  }

 private:
  pid_t pid_ = 0;
};

/// Is it so, sooner or later? Nothing is judged by how long it took. Gives up after so many looks, 10 ms each at least:
/// where nothing else is said, a fifth of the time from which on a test hangs.
inline bool comes_true(const std::function<bool()>& so, unsigned looks = 20 * hangs_after_s()) {
  for (unsigned i = 0; i < looks; ++i) {
    if (so()) return true;
    ::usleep(10'000);
  }
  return false;
}

}  // namespace foresight

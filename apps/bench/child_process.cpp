#include "apps/bench/child_process.hpp"

#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <cstdio>
#include <cstring>

#include "common/error.hpp"

namespace foresight {

pid_t start_child(const std::function<void()>& job) {
  std::fflush(nullptr);
  const pid_t child = ::fork();
  if (child < 0) throw RuntimeFailure("no process can be made", "end other programs");
  if (child > 0) return child;
  ::prctl(PR_SET_PDEATHSIG, SIGKILL);
  int status = 0;
  try {
    job();
  } catch (const std::exception& error) {
    std::fprintf(stderr, "bench: a process of its own has ended: %s\n", error.what());
    status = 1;
  }
  std::fflush(nullptr);
  ::_exit(status);
}

bool wait_for_child(pid_t child) {
  int status = 0;
  return ::waitpid(child, &status, 0) == child && WIFEXITED(status) && WEXITSTATUS(status) == 0;
}

std::optional<std::string> end_of_child(pid_t child) {
  int status = 0;
  if (::waitpid(child, &status, WNOHANG) == 0) return std::nullopt;
  if (WIFSIGNALED(status)) return std::string("was ended by a signal: ") + ::strsignal(WTERMSIG(status));
  return "has ended with status " + std::to_string(WEXITSTATUS(status));
}

}  // namespace foresight

// The main() of every test program. Tests run in a child process, so that one that crashes or hangs is named, and those
// after it still run: in another child, which is forked, not started, and so costs neither linking nor loading.
//
//   parent:  fork ---- wait ---- "T crashed" -- fork ---- wait -- summary, exit code
//   child:     S.a  S.b  T #                      U  V  W
//
// FORESIGHT_TEST_NO_CHILD=1 runs all in one process, for a debugger.
#include <dlfcn.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <csignal>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "tests/support/patience.hpp"

namespace {

using foresight::hangs_after_s;

/// What the children have begun, in memory that they share with the parent.
struct Progress {
  std::array<char, 1 << 18> begun;  ///< full names, each with a ':' behind; "Suite.*" while a suite is set up
  std::size_t size;
  bool running;  ///< the last of them has not ended
  bool at_end;   ///< all that were to run have ended
};

class Reporter final : public testing::EmptyTestEventListener {
 public:
  explicit Reporter(Progress& progress) : progress_(progress), before_(progress.size) {}

 private:
  void OnTestIterationStart(const testing::UnitTest&, int) override { progress_.size = before_; }
  void OnTestSuiteStart(const testing::TestSuite& suite) override {
    suite_at_ = progress_.size;
    begin(std::string(suite.name()) + ".*:");
  }
  void OnTestStart(const testing::TestInfo& test) override {
    if (suite_at_ != kNone) progress_.size = std::exchange(suite_at_, kNone);
    begin(std::string(test.test_suite_name()) + '.' + test.name() + ':');
  }
  void OnTestEnd(const testing::TestInfo&) override {
    ::alarm(0);
    progress_.running = false;
  }
  void OnTestProgramEnd(const testing::UnitTest&) override { progress_.at_end = true; }

  void begin(const std::string& name) {
    if (progress_.size + name.size() > progress_.begun.size()) std::abort();  // make `begun` larger
    std::memcpy(&progress_.begun[progress_.size], name.data(), name.size());
    progress_.size += name.size();
    progress_.running = true;
    ::alarm(hangs_after_s());  // its signal ends this process
  }

  static constexpr std::size_t kNone = SIZE_MAX;
  Progress& progress_;
  const std::size_t before_;      ///< of `begun`: what earlier children began
  std::size_t suite_at_ = kNone;  ///< where `begun` names a suite that has not come to its first test
};

std::string what_ended_it(int status) {
  if (!WIFSIGNALED(status)) return "ended its process, exit code " + std::to_string(WEXITSTATUS(status));
  if (WTERMSIG(status) == SIGALRM) return "hung for " + std::to_string(hangs_after_s()) + " s";
  return "crashed: " + std::string(::strsignal(WTERMSIG(status)));
}

/// LTTng's tracing, which libcamera brings along, has threads of its own. A child has none of them, and would look for
/// them at its end, so it has to be told of the fork (lttng-ust(3), "Using LTTng-UST with daemons").
pid_t fork_and_tell() {
  using Tell = void (*)(sigset_t*);
  const auto tell = [](const char* name, sigset_t& signals) {
    if (const auto function = reinterpret_cast<Tell>(::dlsym(RTLD_DEFAULT, name))) function(&signals);
  };
  sigset_t signals{};
  tell("lttng_ust_before_fork", signals);
  const pid_t child = ::fork();
  tell(child == 0 ? "lttng_ust_after_fork_child" : "lttng_ust_after_fork_parent", signals);
  return child;
}

/// Runs what `filter` selects and no child has begun. Does not return.
[[noreturn]] void run_the_rest(Progress& progress, const std::string& filter) {
  ::prctl(PR_SET_PDEATHSIG, SIGKILL);
  const std::string begun(progress.begun.data(), progress.size);
  if (!begun.empty()) GTEST_FLAG_SET(filter, filter + (filter.find('-') == filter.npos ? "-" : ":") + begun);
  testing::UnitTest::GetInstance()->listeners().Append(new Reporter(progress));
  std::exit(RUN_ALL_TESTS());
}

/// Waits for `child`; false where it cannot be waited for.
bool wait_for(pid_t child, int& status) {
  while (::waitpid(child, &status, 0) < 0)
    if (errno != EINTR) return false;
  return true;
}

std::string_view last_name(const Progress& progress) {
  const std::string_view begun(progress.begun.data(), progress.size ? progress.size - 1 : 0);
  return begun.substr(begun.rfind(':') + 1);  // npos + 1 is 0
}

}  // namespace

int main(int argc, char** argv) {
  testing::InitGoogleMock(&argc, argv);
  if (std::getenv("FORESIGHT_TEST_NO_CHILD") || GTEST_FLAG_GET(list_tests)) return RUN_ALL_TESTS();

  void* const shared = ::mmap(nullptr, sizeof(Progress), PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
  if (shared == MAP_FAILED) return std::perror("mmap"), 1;
  Progress& progress = *static_cast<Progress*>(shared);
  const std::string filter = GTEST_FLAG_GET(filter);
  std::vector<std::string> broken;
  int status = 0;
  for (bool comes_on = true; comes_on && !progress.at_end;) {
    const std::size_t before = progress.size;
    progress.running = false;
    std::fflush(nullptr);  // else both processes write what is in the buffers
    const pid_t child = fork_and_tell();
    if (child == 0) run_the_rest(progress, filter);
    if (child < 0 || !wait_for(child, status)) return std::perror("a child for the tests"), 1;
    comes_on = progress.size > before;
    if (progress.at_end) {
      if (WIFSIGNALED(status)) broken.push_back("the program " + what_ended_it(status) + " at its end");
    } else {
      broken.push_back((progress.running ? "" : "after ") + std::string(last_name(progress)) + " " +
                       what_ended_it(status));
      std::printf("[  CRASHED ] %s\n", broken.back().c_str());
    }
  }
  for (const std::string& one : broken) std::printf("[  FAILED  ] %s\n", one.c_str());
  if (!broken.empty()) return 1;
  return WEXITSTATUS(status);  // also what a leak checker says at the end
}

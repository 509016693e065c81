// Two programs at one output, one of which may have died.
#include "apps/command_line/output_lock.hpp"

#include <sys/wait.h>
#include <unistd.h>

#include "apps/command_line/output_guard.hpp"
#include "common/partial_path.hpp"
#include "tests/scene/test_run.hpp"

namespace foresight::output_lock_test {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

std::size_t entries(const fs::path& folder) {
  return static_cast<std::size_t>(std::distance(fs::directory_iterator(folder), {}));
}

/// The number of a process that ran and ended.
pid_t dead_process() {
  const pid_t child = ::fork();
  if (child == 0) ::_exit(0);
  ::waitpid(child, nullptr, 0);
  return child;
}

TEST(OutputLock, ASecondOneIsRefusedUntilTheFirstEnds) {
  const TempFolder folder;
  {
    const OutputLock first("--out a", folder / "a");
    EXPECT_THAT(input_error([&] { OutputLock("--out a", folder / "a"); }),
                says("--out a", "another program is writing it (process " + std::to_string(::getpid()), "wait"));
    EXPECT_EQ(input_error([&] { OutputLock("--out b", folder / "b"); }), "no error");
    EXPECT_EQ(entries(folder.path()), 1U);
  }
  EXPECT_EQ(entries(folder.path()), 0U);
  EXPECT_EQ(input_error([&] { OutputLock("--out a", folder / "a"); }), "no error");
}

TEST(OutputLock, WorksWithTheLongestNames) {
  const TempFolder folder;
  const fs::path target = folder / std::string(255, 'x');
  const OutputLock first("--out", target);
  EXPECT_THAT(input_error([&] { OutputLock("--out", target); }), HasSubstr("another program"));
}

TEST(OutputLock, ADeadProgramHoldsNothing) {
  const TempFolder folder;
  const pid_t child = ::fork();
  if (child == 0) {
    new OutputLock("--out", folder / "a");  // dies with it held
    ::_exit(0);
  }
  ::waitpid(child, nullptr, 0);
  ASSERT_EQ(entries(folder.path()), 1U);
  EXPECT_EQ(input_error([&] { OutputLock("--out", folder / "a"); }), "no error");
  EXPECT_EQ(entries(folder.path()), 0U);
}

TEST(Partial, OnlyWhatDeadProgramsLeftIsSwept) {
  const TempFolder folder;
  const std::string dead = ".partial-" + std::to_string(dead_process());
  folder.write("a" + dead, "half");
  folder.write("run" + dead + "/rgb/0.png", "half");
  folder.write("a.partial-1", "of a living one");  // init
  folder.write("ab" + dead, "of another");
  folder.write("a.partial-x", "the user's");
  EXPECT_EQ(partial_path(folder / "a").filename().string(), "a.partial-" + std::to_string(::getpid()));
  for (const char* name : {"a", "run"}) {
    const OutputGuard guard({{"--out", (folder / name).string(), [](const fs::path& path) -> std::vector<Output> {
                                return {{path, Output::Kind::either}};
                              }}});
  }
  EXPECT_FALSE(fs::exists(folder / ("a" + dead)));
  EXPECT_FALSE(fs::exists(folder / ("run" + dead)));
  EXPECT_TRUE(fs::exists(folder / "a.partial-1"));
  EXPECT_TRUE(fs::exists(folder / ("ab" + dead)));
  EXPECT_TRUE(fs::exists(folder / "a.partial-x"));
  sweep_partials_in(folder.path());
  EXPECT_FALSE(fs::exists(folder / ("ab" + dead)));
}

// Whose parent never waits for it, as in many containers.
TEST(Partial, AProgramThatEndedIsDeadBeforeItsParentKnows) {
  const TempFolder folder;
  const pid_t child = ::fork();
  if (child == 0) ::_exit(0);
  siginfo_t ended{};
  ::waitid(P_PID, static_cast<id_t>(child), &ended, WEXITED | WNOWAIT);
  folder.write("a.partial-" + std::to_string(child), "half");
  sweep_partials(folder / "a");
  EXPECT_EQ(entries(folder.path()), 0U);
  ::waitpid(child, nullptr, 0);
}

}  // namespace
}  // namespace foresight::output_lock_test

// What a stop signal takes along, in a program of its own.
#include "common/removed_when_stopped.hpp"

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <fstream>
#include <functional>
#include <optional>

#include "apps/command_line/writable.hpp"
#include "common/stop_signal.hpp"
#include "scene/target_folder.hpp"
#include "tests/scene/test_run.hpp"

namespace foresight::removed_when_stopped_test {
namespace {

namespace fs = std::filesystem;

/// Exit code of a process that does this.
int in_a_process(const std::function<void()>& work) {
  const pid_t child = ::fork();
  if (child == 0) {
    end_on_stop_signals();
    work();
    ::_exit(0);
  }
  int status = -1;
  ::waitpid(child, &status, 0);
  return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

TEST(RemovedWhenStopped, IsGoneAfterASignalAndStaysOtherwise) {
  const TempFolder folder;
  const fs::path stays = folder.write("stays", "1"), goes = folder.write("goes", "1");
  EXPECT_EQ(in_a_process([&] {
              std::optional<RemovedWhenStopped> done(std::in_place, stays);
              const RemovedWhenStopped unfinished(goes);
              done.reset();
              ::raise(SIGTERM);
            }),
            kStopped);
  EXPECT_TRUE(fs::exists(stays));
  EXPECT_FALSE(fs::exists(goes));
}

TEST(RemovedWhenStopped, FoldersThatWereMadeGoAfterWhatWasInThemAndStayWithWhatStays) {
  const TempFolder folder;
  const fs::path outer = folder / "outer", inner = outer / "inner", other = folder / "other";
  EXPECT_EQ(in_a_process([&] {
              const MadeFolder first(outer), second(inner), kept(other);
              const fs::path file = inner / "file";
              const RemovedWhenStopped unfinished(file);
              std::ofstream(file) << "1";
              std::ofstream(other / "file") << "1";
              ::raise(SIGTERM);
            }),
            kStopped);
  EXPECT_FALSE(fs::exists(outer));
  EXPECT_TRUE(fs::exists(other / "file"));
}

TEST(RemovedWhenStopped, ASignalWaitsWhileSomethingIsMade) {
  const TempFolder folder;
  const fs::path made = folder / "made", waited = folder / "waited";
  EXPECT_EQ(in_a_process([&] {
              std::optional<RemovedWhenStopped> removed;
              const StopSignalsHeld held;
              ::raise(SIGTERM);
              std::ofstream(waited) << "1";
              std::ofstream(made) << "1";
              removed.emplace(made);
            }),
            kStopped);
  EXPECT_TRUE(fs::exists(waited));
  EXPECT_FALSE(fs::exists(made));
}

TEST(RemovedWhenStopped, ATargetFolderGoesFromItsFirstInstantOn) {
  const TempFolder folder;
  EXPECT_EQ(in_a_process([&] {
              const TargetFolder target(folder / "run", {});
              ::raise(SIGTERM);
            }),
            kStopped);
  EXPECT_TRUE(fs::is_empty(folder.path()));
}

}  // namespace
}  // namespace foresight::removed_when_stopped_test

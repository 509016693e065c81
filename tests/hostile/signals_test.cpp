// SIGINT, SIGTERM and SIGHUP stop every kind of work alike.
#include <algorithm>
#include <csignal>
#include <cstring>
#include <thread>

#include "tests/apps/program.hpp"
#include "tests/hostile/victim.hpp"

namespace foresight::signals_test {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

constexpr int kSignals[] = {SIGINT, SIGTERM, SIGHUP};

class Signals : public testing::TestWithParam<int> {
 protected:
  /// Sends the signal once `begun` holds.
  Outcome stop(const std::string& command, const CommandWords& more, const std::function<bool()>& begun) const {
    Program program(victim_.line(command, more));
    while (program.running() && !begun()) std::this_thread::sleep_for(std::chrono::milliseconds(2));
    EXPECT_TRUE(program.running()) << program.wait().err;
    program.interrupt(GetParam());
    return program.wait(std::chrono::seconds(120));
  }
  bool holds(const std::string& part) const {
    if (fs::exists(victim_ / "new"))
      for (const auto& entry : fs::recursive_directory_iterator(victim_ / "new"))
        if (entry.path().filename().string().find(part) != std::string::npos) return true;
    return false;
  }
  std::size_t left() const {
    return fs::exists(victim_ / "new")
               ? static_cast<std::size_t>(std::distance(fs::recursive_directory_iterator(victim_ / "new"), {}))
               : 0;
  }

  const Victim victim_;
};

TEST_P(Signals, ARobotIsStoppedUnderControl) {
  victim_.write("endless.csv", "time_s,elbow\n0,0.2\n1,0.6\n1000000,0.6\n");
  const Outcome outcome = stop("robot", {{"--follow", {"@endless.csv"}}, {"--log", {"@new/can.log"}}}, [&] {
    std::error_code none;
    const auto size = fs::file_size(victim_ / "new/can-arm.log", none);
    return !none && size > 100'000;
  });
  EXPECT_EQ(outcome.exit_code, 130) << outcome.err;
  EXPECT_THAT(outcome.out, HasSubstr(": disabled"));
}

TEST_P(Signals, WhatPollsEndsItselfAndLeavesNothing) {
  fs::create_directory(victim_ / "new");
  // In the folder in which it works: until then it does not poll. A file of that name only tries whether one can be
  // written.
  const auto works = [&] {
    return std::ranges::any_of(fs::directory_iterator(victim_ / "new"), [](const fs::directory_entry& entry) {
      const bool is_partial = entry.path().filename().string().find(".partial-") != std::string::npos;
      return is_partial && entry.is_directory() && !fs::is_empty(entry.path());
    });
  };
  const Outcome outcome = stop("synth", {{"--frames", {"10000"}}}, works);
  EXPECT_EQ(outcome.exit_code, 130) << outcome.err;
  EXPECT_THAT(outcome.last_line(), HasSubstr("nothing was written"));
  EXPECT_EQ(left(), 0U);
}

TEST_P(Signals, WhatDoesNotPollEndsAtOnceAndLeavesNoLock) {
  fs::create_directory(victim_ / "new");
  const Outcome outcome = stop("bench prediction ik", {{"--poses", {"10000000"}}, {"--json", {"@new/ik.json"}}},
                               [&] { return holds(".lock"); });
  EXPECT_EQ(outcome.exit_code, 130) << outcome.err;
  EXPECT_THAT(outcome.last_line(), HasSubstr("stopped by"));
  EXPECT_EQ(left(), 0U);
}

INSTANTIATE_TEST_SUITE_P(All, Signals, testing::ValuesIn(kSignals),
                         [](const auto& i) { return std::string(::sigabbrev_np(i.param)); });

TEST(SignalsOff, NohupStaysInForce) {
  const Victim victim;
  fs::create_directory(victim / "new");
  Program program(victim.line("bench prediction ik", {{"--poses", {"10000000"}}, {"--json", {"@new/ik.json"}}}),
                  {.shell = "trap '' HUP"});
  while (program.running() && fs::is_empty(victim / "new")) std::this_thread::sleep_for(std::chrono::milliseconds(2));
  program.interrupt(SIGHUP);
  program.interrupt(SIGTERM);
  const Outcome outcome = program.wait();
  EXPECT_EQ(outcome.exit_code, 130);
  EXPECT_THAT(outcome.last_line(), HasSubstr("SIGTERM"));
}

// The first writes for ever; the second is refused, the third takes what a killed one left.
TEST(TwoPrograms, OneFolderHasOneWriter) {
  const Victim victim;
  fs::create_directory(victim / "new");
  const auto endless = victim.line("synth", {{"--frames", {"10000"}}});
  Program first(endless);
  while (first.running() && fs::is_empty(victim / "new")) std::this_thread::sleep_for(std::chrono::milliseconds(2));
  const Outcome second = run_program(victim.line("record", {{"OUT", {"@new/synth"}}}));
  EXPECT_EQ(second.exit_code, 2);
  EXPECT_THAT(second.last_line(), testing::AllOf(HasSubstr("another program is writing"),
                                                 HasSubstr("process " + std::to_string(first.pid()))));
  while (first.running() && std::distance(fs::directory_iterator(victim / "new"), {}) < 2)
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
  first.interrupt(SIGKILL);
  first.wait();
  EXPECT_FALSE(fs::is_empty(victim / "new"));
  EXPECT_EQ(run_program(victim.line("synth", {})).exit_code, 0);
  EXPECT_EQ(std::distance(fs::directory_iterator(victim / "new"), {}), 1) << "lock and half a run are gone";
}

}  // namespace
}  // namespace foresight::signals_test

// Full, closed and limited: exit code 1 and a word, and nothing half-written under its final name.
#include <unistd.h>

#include <algorithm>
#include <set>

#include "tests/apps/program.hpp"
#include "tests/hostile/victim.hpp"

namespace foresight::limits_test {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::HasSubstr;

class Limits : public testing::Test {
 protected:
  Outcome run(const std::string& command, const CommandWords& more, const std::string& shell) const {
    return Program(victim_.line(command, more), {.shell = shell}).wait(std::chrono::seconds(120));
  }
  std::set<std::string> new_files() const {
    std::set<std::string> out;
    if (fs::exists(victim_ / "new"))
      for (const auto& entry : fs::recursive_directory_iterator(victim_ / "new"))
        if (!entry.is_directory()) out.insert(entry.path().lexically_relative(victim_ / "new").string());
    return out;
  }
  void expect_failure(const Outcome& outcome, const std::string& what) const {
    EXPECT_EQ(outcome.exit_code, 1) << outcome.err;
    EXPECT_THAT(outcome.last_line(), AllOf(testing::StartsWith("foresight: "), HasSubstr(what)));
  }

  const Victim victim_;
  const std::map<std::string, std::string> before_ = victim_.snapshot();
};

TEST_F(Limits, WhatStdoutDoesNotTakeIsTold) {
  const std::vector<std::pair<std::string, CommandWords>> talkers = {
      {"can explain", {}},      {"can scan", {}},        {"doctor", {}},
      {"calibrate target", {}}, {"calibrate scene", {}}, {"bench prediction ik", {}}};
  for (const auto& [command, more] : talkers) {
    SCOPED_TRACE(command);
    expect_failure(run(command, more, "exec >/dev/full"), "stdout: not all could be written (No space left");
    expect_failure(run(command, more, "exec >&-"), "stdout: not all could be written (Bad file descriptor");
  }
  const Outcome help = Program({"--help"}, {.shell = "exec >/dev/full"}).wait();
  expect_failure(help, "stdout: not all could be written");
}

// As `| head` does when it has its lines.
TEST_F(Limits, AReaderThatHasSeenEnoughIsNoError) {
  const std::string pipe = victim_ / "fifo";
  const Outcome outcome =
      run("can explain", {}, "exec 3<>" + pipe + " && exec 4>" + pipe + " && exec 3<&- && exec >&4");
  EXPECT_EQ(outcome.exit_code, 0);
  EXPECT_EQ(outcome.err, "");
}

// Files that are opened must not become what a closed stream was.
TEST_F(Limits, ClosedStreamsAreNobodysFile) {
  for (const char* closed : {"exec <&-", "exec 2>&-", "exec <&- 2>&-"}) {
    SCOPED_TRACE(closed);
    fs::remove_all(victim_ / "new");
    const Outcome outcome = run("calibrate scene", {{"--json", {"@new/n.json"}}, {"--out", {"@new/s.yaml"}}}, closed);
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
    EXPECT_THAT(victim_.read("new/n.json"), testing::StartsWith("{\n  \"generator\": \"foresight\""));
    EXPECT_THAT(victim_.read("new/s.yaml"), testing::StartsWith("kind: scene"));
  }
  fs::remove_all(victim_ / "new");
  const Outcome all = run("calibrate scene", {{"--json", {"@new/n.json"}}}, "exec <&- >&- 2>&-");
  EXPECT_EQ(all.exit_code, 1);
  EXPECT_THAT(victim_.read("new/n.json"), testing::StartsWith("{\n  \"generator\": \"foresight\""));
}

// 512 bytes: less than any of these writes.
TEST_F(Limits, ALimitOnFilesIsToldAndLeavesNone) {
  const std::vector<std::pair<std::string, CommandWords>> writers = {
      {"calibrate target", {}},
      {"calibrate scene", {{"--report", {"@new/s.html"}}}},
      {"calibrate display", {{"--pattern-out", {"@new/p.png"}}}},
      {"bench prediction ik", {{"--json", {"@new/ik.json"}}}},
      {"replay", {{"--report", {"@new/r.json"}}}},
      {"export", {}},
      {"synth", {}},
  };
  for (const auto& [command, more] : writers) {
    SCOPED_TRACE(command);
    fs::remove_all(victim_ / "new");
    expect_failure(run(command, more, "ulimit -f 1"), "File too large");
    EXPECT_THAT(new_files(), testing::IsEmpty());
  }
}

TEST_F(Limits, ALogThatEndsIsToldAndTheRobotWasStopped) {
  const Outcome outcome = run("robot", {{"--follow", {"@motion.csv"}}, {"--log", {"@new/can.log"}}}, "ulimit -f 64");
  EXPECT_EQ(outcome.exit_code, 1) << outcome.err;
  EXPECT_THAT(outcome.err, HasSubstr("File too large"));
  EXPECT_THAT(outcome.out, HasSubstr(": disabled"));
}

TEST_F(Limits, LittleMemoryIsToldAndNoSignal) {
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
  GTEST_SKIP() << "a sanitizer alone takes more addresses than this leaves";
#endif
  for (const char* command : {"replay", "export", "bench extraction"}) {
    SCOPED_TRACE(command);
    fs::remove_all(victim_ / "new");
    const Outcome outcome = run(command, {}, "ulimit -v 600000");
    EXPECT_EQ(outcome.exit_code, 1) << outcome.err;
    EXPECT_THAT(outcome.last_line(), AllOf(testing::StartsWith("foresight: "), HasSubstr("ulimit -v")));
    EXPECT_THAT(new_files(), testing::IsEmpty());
  }
}

TEST_F(Limits, WhatAKilledProgramLeftIsSwept) {
  const pid_t dead = [] {
    const Program program({"--help"});
    return program.pid();  // it has been waited for
  }();
  victim_.write("new/s.yaml.partial-" + std::to_string(dead), "half");
  const Outcome outcome = run("calibrate scene", {{"--out", {"@new/s.yaml"}}}, "");
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_THAT(new_files(), testing::ElementsAre("s.yaml"));
}

TEST_F(Limits, NumbersThatAreNoneAreRefusedByName) {
  const std::vector<std::pair<std::string, CommandWords>> all = {
      {"record", {{"--pose", {"nan", "0", "0", "0", "0", "0", "1"}}}},
      {"record", {{"--pose", {"0", "0", "inf", "0", "0", "0", "1"}}}},
      {"calibrate time", {{"--around", {"nan"}}}},
      {"calibrate arm", {{"--head-angles", {"nan", "0"}}, {"--head", {"@result.yaml"}}}},
      {"synth", {{"--exposure", {"inf"}}}},
      {"synth", {{"--noise", {"nan"}}}},
  };
  for (const auto& [command, more] : all) {
    const Outcome outcome = run(command, more, "");
    EXPECT_EQ(outcome.exit_code, 2);
    EXPECT_THAT(outcome.last_line(), AllOf(HasSubstr(more[0].first), HasSubstr("not a finite number")));
    EXPECT_THAT(victim_.changes(before_), testing::IsEmpty());
  }
}

}  // namespace
}  // namespace foresight::limits_test

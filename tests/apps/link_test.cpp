// `foresight robot --serve` and `foresight link`, in a network of the test's own.
#include <optional>
#include <thread>

#include "tests/apps/program.hpp"
#include "tests/scene/test_run.hpp"
#include "tests/support/folders.hpp"
#include "tests/support/private_network.hpp"

namespace foresight::link_test {
namespace {

using testing::HasSubstr;

class Link : public PrivateNetworkTest {
 protected:
  static std::string rig() { return (source_folder() / "configs" / "minerva.yaml").string(); }
};

// A robot whose drives are not enabled tells its state; who looks at it sees program, topics and messages.
TEST_F(Link, ARunningRobotIsSeenAndReadAndNamesAreHelpedWith) {
  Program robot({"robot", rig(), "--mock", "--no-cameras", "--serve"});
  const Outcome state = run_program({"link", "listen", "/foresight/robot_state", "--count", "2"});
  EXPECT_EQ(state.exit_code, 0) << state.err;
  EXPECT_THAT(state.out, HasSubstr("rig: 'minerva'\nphase:\n  label: 'disabled'"));
  const Outcome status = run_program({"link", "status", "--rig", rig(), "--seconds", "1"});
  EXPECT_EQ(status.exit_code, 0) << status.err;
  EXPECT_THAT(status.out, HasSubstr("robot minerva, on "));
  EXPECT_THAT(status.out, HasSubstr("  writes rt/joint_states (sensor_msgs/msg/JointState)"));
  const Outcome rate = run_program({"link", "rate", "foresight/robot_state", "--seconds", "1"});
  EXPECT_EQ(rate.exit_code, 0) << rate.err;
  EXPECT_THAT(rate.out, HasSubstr("rt/foresight/robot_state (foresight_msgs/msg/RobotState)\nrate "));
  const Outcome kept = run_program({"link", "listen", "tf_static", "--count", "1"});
  EXPECT_EQ(kept.exit_code, 0) << kept.err;
  EXPECT_THAT(kept.out, HasSubstr("child_frame_id: 'stand'"));
  const Outcome silent = run_program({"link", "listen", "joint_states", "--seconds", "0.2"});
  EXPECT_EQ(silent.exit_code, 1) << "joints that are not homed are nowhere";
  EXPECT_EQ(silent.last_line(),
            "link: nothing came on rt/joint_states, though somebody writes it: where joints are that are not homed is "
            "not known; home those of 'minerva' (h in its console, H at the operator's seat)");
  const Outcome misspelt = run_program({"link", "listen", "joint_stats"});
  EXPECT_EQ(misspelt.exit_code, 2);
  EXPECT_THAT(misspelt.err, HasSubstr("did you mean 'rt/joint_states'?"));
  robot.interrupt();
  const Outcome end = robot.wait();
  EXPECT_EQ(end.exit_code, 130) << end.err;
  EXPECT_THAT(end.err, HasSubstr("robot: serving on domain 0, interface lo"));
}

// Two robots of a lab that both kept the domain of the rig that they were copied from.
TEST_F(Link, ASecondRobotIsNotServedBesideTheFirst) {
  const std::vector<std::string> served{"robot", rig(), "--mock", "--no-cameras", "--serve"};
  Program first(served);
  const Outcome there = run_program({"link", "listen", "foresight/robot_state", "--count", "1"});
  ASSERT_EQ(there.exit_code, 0) << there.err;
  const Outcome second = run_program(served);
  EXPECT_EQ(second.exit_code, 2);
  EXPECT_THAT(second.last_line(), HasSubstr(rig() + ": cannot be served beside 'robot minerva'"));
  EXPECT_THAT(second.last_line(), HasSubstr("give this rig another link.domain"));
  const auto gone = "has gone from the domain: operators hear this robot alone";
  for (int i = 0; i < 200 && first.said().find(gone) == std::string::npos; ++i)
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
  first.interrupt();
  const Outcome end = first.wait();
  EXPECT_EQ(end.exit_code, 130);
  EXPECT_THAT(end.err, HasSubstr("line: 'robot minerva' on "));
  EXPECT_THAT(end.err, HasSubstr("has come to the same domain, and operators hear both"));
  EXPECT_THAT(end.err, HasSubstr(gone));
}

TEST_F(Link, ASecondRobotIsRefusedBeforeItsLabIsLit) {
  Program first({"robot", rig(), "--mock", "--no-cameras", "--serve"});
  ASSERT_EQ(run_program({"link", "listen", "foresight/robot_state", "--count", "1"}).exit_code, 0);
  const Outcome second = run_program({"robot", rig(), "--mock", "--serve"});
  EXPECT_EQ(second.exit_code, 2);
  EXPECT_THAT(second.last_line(), HasSubstr("cannot be served beside 'robot minerva'"));
  EXPECT_THAT(second.err, testing::Not(HasSubstr("lighting the lab")));
}

// The robot is killed: who listens is told, waits with words, and hears the next one.
TEST_F(Link, ARobotThatHasGoneIsToldToWhoListens) {
  const auto robot = [] { return Program({"robot", rig(), "--mock", "--no-cameras", "--serve"}); };
  const auto said = [](Program& listener, const char* words) {
    while (listener.running() && listener.said().find(words) == std::string::npos)
      std::this_thread::sleep_for(std::chrono::milliseconds(50));
    EXPECT_THAT(listener.said(), HasSubstr(words));
  };
  std::optional<Program> listener;
  {
    Program first = robot();
    const Outcome there = run_program({"link", "listen", "foresight/robot_state", "--count", "1"});
    ASSERT_EQ(there.exit_code, 0) << there.err;
    listener.emplace(std::vector<std::string>{"link", "listen", "foresight/robot_state", "--count", "100000"});
    const Outcome more = run_program({"link", "listen", "foresight/robot_state", "--count", "20"});
    ASSERT_EQ(more.exit_code, 0) << more.err;
    first.interrupt(SIGKILL);
    first.wait();
  }
  said(*listener, "nobody writes rt/foresight/robot_state any more");
  Program second = robot();
  said(*listener, "rt/foresight/robot_state is written again");
  listener->interrupt();
  EXPECT_EQ(listener->wait().exit_code, 0) << listener->said();
}

/// The number after `words` in `text`; -1 where they are not there.
double number_after(const std::string& text, const std::string& words) {
  const std::size_t at = text.find(words);
  return at == text.npos ? -1 : std::strtod(text.c_str() + at + words.size(), nullptr);
}

// Both programs have one clock: whatever the line between them, it is within the bound, and the line's delay shows.
TEST_F(Link, StatusMeasuresTheClockOverAPretendedLine) {
  const TempFolder folder;
  const std::string line = folder.write("line.yaml", "up: {delay_ms: 40, loss: 0.05}\ndown: {delay_ms: 10}\n");
  Program robot({"robot", rig(), "--mock", "--no-cameras", "--serve", "--line", line});
  const Outcome there = run_program({"link", "listen", "/foresight/robot_state", "--count", "1"});
  ASSERT_EQ(there.exit_code, 0) << there.err;
  const Outcome status = run_program({"link", "status", "--seconds", "3"});
  EXPECT_EQ(status.exit_code, 0) << status.err;
  EXPECT_THAT(status.out, HasSubstr("pairs      none came\n"));
  const double ahead_ms = 1e3 * number_after(status.out, "clock      the robot's is "),
               bound_ms = number_after(status.out, "ahead, +- "), trip_ms = number_after(status.out, "round trip ");
  EXPECT_GE(trip_ms, 50) << status.out;
  EXPECT_GE(bound_ms, 20) << status.out;
  EXPECT_LE(std::abs(ahead_ms), bound_ms) << status.out;
  const Outcome both = run_program({"link", "status", "--seconds", "3", "--line", line});
  EXPECT_GE(number_after(both.out, "round trip "), 100) << both.out;
  robot.interrupt();
  const Outcome end = robot.wait();
  EXPECT_EQ(end.exit_code, 130) << end.err;
  EXPECT_THAT(end.err, HasSubstr("robot: everything on the line passes " + line));
}

TEST_F(Link, NobodyThereIsSaidAndCured) {
  const Outcome status = run_program({"link", "status", "--domain", "9", "--seconds", "0.5"});
  EXPECT_EQ(status.exit_code, 1);
  EXPECT_THAT(status.out, HasSubstr("domain 9, interface lo: 0 other programs"));
  EXPECT_THAT(status.err, HasSubstr("foresight robot RIG --serve"));
}

TEST_F(Link, WhatCannotBeIsRefused) {
  const auto refused = [](const std::vector<std::string>& arguments, const char* words) {
    const Outcome out = run_program(arguments);
    EXPECT_EQ(out.exit_code, 2) << arguments[1];
    EXPECT_THAT(out.err, HasSubstr(words));
  };
  refused({"link", "status", "--interface", "eth9"},
          "there is no network interface 'eth9'; set link.interface to one of");
  refused({"link", "status", "--peer", "no-such-host.invalid"}, "nobody knows the peer 'no-such-host.invalid'");
  refused({"link", "rate", "joint_states", "--domain", "77"}, "nobody writes this topic");
  refused({"robot", rig(), "--mock", "--stepped", "--serve"}, "a network's time cannot be stepped");
  refused({"robot", rig(), "--mock", "--line", rig()}, "--line: belongs to --serve");
  const TempFolder folder;
  const std::string wrong = folder.write("line.yaml", "up: {delay: 40}\n");
  refused({"robot", rig(), "--mock", "--no-cameras", "--serve", "--line", wrong}, "line.yaml:1");
  refused({"link", "status", "--line", wrong}, "line.yaml:1");
}

// Half of the keys would let one host in, and no other.
TEST(LinkKeys, AFullDiskLeavesNone) {
  const TempFolder folder;
  const Outcome full = run_program({"link", "keys", (folder / "keys/").string()}, {.shell = "ulimit -f 1"});
  EXPECT_EQ(full.exit_code, 1);
  EXPECT_THAT(full.last_line(), HasSubstr("cannot write"));
  EXPECT_TRUE(std::filesystem::is_empty(folder.path()));
}

}  // namespace
}  // namespace foresight::link_test

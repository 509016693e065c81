#include "drivers/robot/robot_words.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <set>

namespace foresight::robot_words_test {
namespace {

/// All of an enumeration whose first value is 0: those that the table knows, one after the other.
template <typename E>
std::vector<E> all_of_table() {
  std::vector<E> out;
  for (int i = 0; std::string(words_for(static_cast<E>(i)).label) != "?"; ++i) out.push_back(static_cast<E>(i));
  return out;
}

template <typename E>
void expect_words(E last, std::size_t without = 0) {
  const auto all = all_of_table<E>();
  ASSERT_EQ(all.size(), static_cast<std::size_t>(last) + 1);
  std::set<std::string> names;
  for (const E value : all) {
    const StateWords words = words_for(value);
    if (static_cast<std::size_t>(value) < without) continue;
    for (const char* text : {words.label, words.name, words.cure})
      EXPECT_GT(std::string(text).size(), 2u) << words.name;
    EXPECT_NE(std::string(words.name).back(), '.') << words.name;
    EXPECT_TRUE(names.insert(words.name).second) << words.name << " twice";
  }
}

TEST(RobotWords, EveryStateAndReasonHasItsNameAndItsCure) {
  expect_words(RobotPhase::setting_up);
  expect_words(GateState::stopped);
  expect_words(GateReason::stands_out_of_range, 1);  // but none
  expect_words(DriveState::fault);
}

const std::vector<JointWords> kJoints = {{"yaw", "rad"}, {"finger", "m"}};

TEST(RobotWords, SayWhatTheRobotDoesAndWhatToDo) {
  RobotStatus status;
  status.phase = RobotPhase::stopped;
  status.gate = {.state = GateState::stopped, .reason = GateReason::emergency_stop};
  EXPECT_EQ(describe(status, kJoints).name, "stopped by the operator; drives hold");
  EXPECT_EQ(describe(status, kJoints).cure, "reset (r) once the way is clear");
  status.waiting_for = 0;
  EXPECT_EQ(describe(status, kJoints).name, "stopped by the operator; drives hold")
      << "no longer for the joint that homed";
  status.waiting_for = -1;
  status.gate.reason = GateReason::drive_fault;
  status.gate.joint = 1;
  status.gate.detail = "overcurrent";
  EXPECT_EQ(describe(status, kJoints).name, "stopped: the drive reports a fault (finger): overcurrent; drives hold");
  EXPECT_THAT(describe(status, kJoints).cure, testing::HasSubstr("then reset"));
  status = {};
  status.gate = {.state = GateState::stopped, .reason = GateReason::not_started};
  EXPECT_EQ(describe(status, kJoints).name, "disabled: no torque, brakes closed");
  status.feedback[1].state = DriveState::enabled;
  EXPECT_EQ(describe(status, kJoints).name, "disabled: no torque, brakes closed, but for finger, which keeps its grip");
  status.feedback[1].state = DriveState::disabled;
  status.phase = RobotPhase::enabling;
  status.waiting_for = 0;
  EXPECT_EQ(describe(status, kJoints).name, "drives are being enabled, waiting for yaw");
  status.phase = RobotPhase::ready;
  status.waiting_for = -1;
  status.gate = {.state = GateState::idle, .reason = GateReason::homing_too_long, .detail = "elbow"};
  EXPECT_THAT(describe(status, kJoints).name, testing::HasSubstr("homing takes longer"))
      << "why is more than what next";
  status.gate = {.state = GateState::idle};
  EXPECT_EQ(describe(status, kJoints).name, "drives hold; not all joints know where they are");
  EXPECT_EQ(describe(status, kJoints).cure, "home them (h)");
  status.all_homed = true;
  status.gate = {.state = GateState::following, .reason = GateReason::obstructed, .detail = "link 'a' leaves"};
  EXPECT_EQ(describe(status, kJoints).name, "ready, follows the operator: the way is obstructed: link 'a' leaves");
}

TEST(RobotWords, AProgramThatStoodStillIsTheCauseOfWhatDrivesSayThen) {
  RobotStatus status;
  status.phase = RobotPhase::stopped;
  status.stood_still = std::chrono::milliseconds(5012);
  status.gate = {.state = GateState::stopped, .reason = GateReason::drive_fault, .joint = 1, .detail = "silence"};
  EXPECT_EQ(
      describe(status, kJoints).name,
      "stopped: the program stood still for 5.0 s, then the drive reports a fault (finger): silence; drives hold");
  EXPECT_THAT(describe(status, kJoints).cure, testing::HasSubstr("held it up"));
  status.gate.reason = GateReason::emergency_stop;
  EXPECT_THAT(describe(status, kJoints).name, testing::StartsWith("stopped by the operator"));
}

TEST(RobotWords, NobodyIsToldToEnableADriveThatHasToBeConfiguredFirst) {
  RobotStatus status;
  status.gate = {.state = GateState::stopped, .reason = GateReason::not_started};
  status.feedback[0].state = DriveState::disabled;
  status.feedback[1].state = DriveState::offline;
  EXPECT_EQ(describe(status, kJoints).cure, "configure drives anew (c), then enable them (e)");
  status.phase = RobotPhase::stopped;
  status.gate.reason = GateReason::not_enabled_in_time;
  EXPECT_EQ(describe(status, kJoints).cure, "configure drives anew (c), then enable them (e)");
  status.feedback[1].state = DriveState::disabled;
  EXPECT_THAT(describe(status, kJoints).cure, testing::HasSubstr("safe torque off"));
  status.phase = RobotPhase::disabled;
  EXPECT_EQ(describe(status, kJoints).cure, "enable the drives (e)");
}

TEST(RobotWords, SayWhatHoldsIt) {
  GateHold hold;
  EXPECT_EQ(hold_text(hold, kJoints, RobotTime{}), "");
  hold = {.joint = 0,
          .stands = 0.25,
          .asked = 1,
          .since = RobotTime{1'000'000'000},
          .parts = "link 'a' comes too close to 'b'",
          .apart = 0.0213,
          .kept_apart = 0.02};
  EXPECT_EQ(
      hold_text(hold, kJoints, RobotTime{4'500'000'000}),
      "held for 3.5 s: joint yaw stands at 0.2500 rad and should be at 1.0000 rad: link 'a' comes too close to 'b' "
      "(21.3 mm apart, 20.0 mm are kept)");
  hold.asked = 0.25004;
  EXPECT_EQ(hold_text(hold, kJoints, RobotTime{4'500'000'000}),
            "held for 3.5 s: link 'a' comes too close to 'b' (21.3 mm apart, 20.0 mm are kept)")
      << "the joint stands where it should be";
  hold.kept_apart = 0;
  hold.parts = "link 'a' leaves the workspace";
  EXPECT_THAT(parts_text(hold), testing::HasSubstr("workspace (21.3 mm before its end)"));
}

}  // namespace
}  // namespace foresight::robot_words_test

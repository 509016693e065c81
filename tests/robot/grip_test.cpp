// What a gripper holds must not fall, and a gripper must not leap.
#include <gtest/gtest.h>

#include "tests/robot/robot_fixture.hpp"

namespace foresight::robot_test {
namespace {

class GripTest : public RobotTest {
 protected:
  static constexpr double kThing = 0.03, kPressed = 0.022;  // metres: as wide as the thing is, and as asked for
  /// The jaws have closed on something rigid.
  void hold_a_thing() {
    grip().stops_at = kThing;
    grip().state.position = 0.05;
    make_ready();
    command(0, 0.05, false);
    run(1);
    for (int i = 0; i < 400; ++i) {
      command(0, kPressed);
      run(1);
    }
    ASSERT_EQ(grip().state.position, kThing);
    ASSERT_NEAR(robot_.status().set_point[1].position, kPressed, 1e-6);
  }
  PromptDrive& arm() { return drives_[0]; }
  PromptDrive& grip() { return drives_[1]; }
};

TEST_F(GripTest, AnEnablingThatFailsDoesNotMoveIt) {
  arm().stuck = true;
  grip().state.position = kThing;
  robot_.ask(RobotRequest::enable);
  run(10);
  ASSERT_EQ(grip().state.state, DriveState::enabled);
  robot_.ask(RobotRequest::emergency_stop);
  run(100);
  EXPECT_EQ(robot_.status().phase, RobotPhase::stopped);
  EXPECT_EQ(grip().state.position, kThing) << "an emergency stop";

  robot_.ask(RobotRequest::reset);
  run(2000);
  EXPECT_EQ(robot_.status().gate.reason, GateReason::not_enabled_in_time);
  EXPECT_EQ(grip().state.state, DriveState::enabled);
  EXPECT_EQ(grip().state.position, kThing) << "a drive that is never enabled";

  arm().stuck = false;
  arm().state.position = 2.5;
  run(100);
  robot_.ask(RobotRequest::reset);
  run(100);
  EXPECT_EQ(robot_.status().gate.reason, GateReason::stands_out_of_range);
  EXPECT_EQ(grip().state.state, DriveState::enabled);
  EXPECT_EQ(grip().state.position, kThing) << "a joint beyond its limits";
}

TEST_F(GripTest, AResetDoesNotLetGo) {
  hold_a_thing();
  robot_.ask(RobotRequest::emergency_stop);
  run(50);
  robot_.ask(RobotRequest::reset);
  run(50);
  ASSERT_EQ(robot_.status().phase, RobotPhase::ready);
  EXPECT_NEAR(robot_.status().set_point[1].position, kPressed, 1e-6);
  grip().stops_at = 0;
  run(1);
  EXPECT_NEAR(grip().state.position, kPressed, 1e-6) << "it has pressed all the while";
}

TEST_F(GripTest, DisablingAndEnablingDoesNotLetGo) {
  hold_a_thing();
  command(0, kPressed, false);
  run(50);
  robot_.ask(RobotRequest::disable);
  run(50);
  ASSERT_EQ(robot_.status().phase, RobotPhase::disabled);
  make_ready();
  EXPECT_NEAR(robot_.status().set_point[1].position, kPressed, 1e-6);
}

TEST_F(GripTest, OneThatWasOffBeginsWhereItStands) {
  hold_a_thing();
  robot_.ask(RobotRequest::emergency_stop);
  run(50);
  grip().state.state = DriveState::disabled;
  grip().stops_at = 0;
  grip().state.position = 0.035;  // opened by hand, by less than the following error
  run(100);
  robot_.ask(RobotRequest::reset);
  run(50);
  ASSERT_EQ(robot_.status().phase, RobotPhase::ready);
  EXPECT_EQ(robot_.status().set_point[1].position, 0.035);
  EXPECT_EQ(grip().state.position, 0.035);
}

TEST_F(GripTest, OneThatStandsFarFromItsSetPointBeginsWhereItStands) {
  hold_a_thing();
  robot_.ask(RobotRequest::emergency_stop);
  run(50);
  grip().stops_at = grip().state.position = 0.06;  // more than the following error: it would stop at once again
  run(100);
  robot_.ask(RobotRequest::reset);
  run(50);
  ASSERT_EQ(robot_.status().phase, RobotPhase::ready);
  EXPECT_EQ(robot_.status().set_point[1].position, 0.06);
}

TEST_F(GripTest, JawsThatPressAreNotTakenForAFrozenEncoder) {
  hold_a_thing();  // for a second, 8 of 20 mm from where they are asked to be
  EXPECT_EQ(robot_.status().gate.state, GateState::following) << to_string(robot_.status().gate.reason);
  for (int i = 0; i < 400; ++i) {
    command(0, 0.005);
    run(1);
  }
  EXPECT_EQ(robot_.status().gate.reason, GateReason::following_error) << "that is still an error";
}

}  // namespace
}  // namespace foresight::robot_test

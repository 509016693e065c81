// Between the desk and the robot's control loop: what the safety gate is told.
#include "operators/line_operator.hpp"

#include "tests/control/small_line.hpp"
#include "tests/robot/prompt_drive.hpp"

namespace foresight::line_operator_test {
namespace {

using namespace std::chrono_literals;

class LineOperatorTest : public testing::Test {
 protected:
  LineOperatorTest() {
    for (PromptDrive& drive : drives_) drive.state.homed = true;
    robot_.ask(RobotRequest::enable);
    seat_.want_control(true);
    run(1s);
  }
  static GateOptions gate_options() {
    GateOptions out;
    out.joints = {{"arm", {-2, 2, 1, 4, 60}, 0.2}, {"wrist", {0, 0.1, 0.1, 1, 20}, 0.02, true}};
    return out;
  }
  /// Four milliseconds; what is sent arrives at once.
  void step() {
    now_ = now_ + 4ms;
    const OperatorTime here{now_.ns + 7'000'000'000};
    seat_.advance(here);
    if (sends_) seat_.command(here, position_, held_);
    for (const FromOperator& message : seat_.take_outgoing()) line_.desk().receive(message, now_);
    Commander* const commander = &line_;
    if (ticks_) serve({&commander, 1}, robot_, now_);
    for (const FromRobot& message : line_.desk().take_outgoing()) seat_.receive(message, here);
    robot_.cycle(now_);
  }
  void run(Duration time) {
    for (const RobotTime end = now_ + time; now_ < end;) step();
  }
  void engage() {
    position_ = seat_.begin();
    held_ = true;
    run(100ms);
    ASSERT_EQ(gate().state, GateState::following);
    ASSERT_EQ(gate().operator_id, LineOperator::kId);
    position_[0] = 1;
    run(500ms);
    ASSERT_GT(robot_.status().set_point[0].velocity, 0.1);
  }
  GateStatus gate() const { return robot_.status().gate; }

  RobotTime now_{5'000'000'000};
  std::vector<PromptDrive> drives_{std::vector<PromptDrive>(2)};
  PromptNetwork network_{drives_};
  Robot robot_{gate_options(), nullptr, {&network_}, {&drives_[0], &drives_[1]}};
  LineOperator line_{gate_options(), desk_options()};
  ControlSeat seat_{{sample_identity("anna"), counting(1)}};
  LinePositions position_{};
  bool held_ = false, sends_ = true, ticks_ = true;
};

TEST_F(LineOperatorTest, TheRobotFollowsAndStopsAtOnceWhereTheSwitchOpens) {
  engage();
  held_ = false;
  run(12ms);
  EXPECT_EQ(gate().reason, GateReason::deadman_released);
}

TEST_F(LineOperatorTest, ALeaseThatEndsStopsAtOnceAndTheGateWantsToSeeTheSwitchOpen) {
  engage();
  line_.desk().end_lease(now_);
  run(12ms);
  EXPECT_EQ(gate().state, GateState::stopping);
  EXPECT_EQ(gate().reason, GateReason::handed_over);
  run(2s);
  EXPECT_EQ(gate().state, GateState::idle);
}

TEST_F(LineOperatorTest, WhatIsNotHeardInTimeIsALossThoughTheLeaseStays) {
  engage();
  sends_ = false;
  run(200ms);
  EXPECT_EQ(gate().reason, GateReason::operator_lost);
}

TEST_F(LineOperatorTest, TheGateStopsWithTheSetPointThoughTheProgramStandsStill) {
  engage();
  const Duration life = line_.desk().permit().life();
  ASSERT_EQ(life, 100ms);
  // The last set-point is as old as it may be when the program's last tick hands it on.
  sends_ = false;
  const RobotTime last = now_;
  run(80ms);
  ticks_ = false;
  while (gate().state == GateState::following) step();
  EXPECT_LE(now_ - last, life + 8ms) << "not a tenth of a second after the last tick";
}

TEST_F(LineOperatorTest, ARobotThatStoppedIsNotMovedOnByAHeldSwitch) {
  engage();
  robot_.ask(RobotRequest::emergency_stop);
  run(1s);
  robot_.ask(RobotRequest::reset);
  run(1s);
  ASSERT_EQ(robot_.status().phase, RobotPhase::ready);
  EXPECT_EQ(gate().state, GateState::idle);
  held_ = false;
  run(100ms);
  engage();
}

TEST_F(LineOperatorTest, AGripperKeepsItsGripWhereSetPointsBegin) {
  engage();
  position_[1] = 0.05;
  run(2s);
  drives_[1].stuck = true;
  held_ = false;
  run(100ms);
  EXPECT_DOUBLE_EQ(seat_.begin()[1], robot_.status().set_point[1].position);
  EXPECT_DOUBLE_EQ(seat_.begin()[0], drives_[0].state.position);
}

}  // namespace
}  // namespace foresight::line_operator_test

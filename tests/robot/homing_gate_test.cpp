#include "tests/robot/gate_fixture.hpp"

namespace foresight::homing_gate_test {
namespace {

// While joint 0 looks for home.
class HomingGateTest : public SafetyGateTest {
 protected:
  void SetUp() override { ASSERT_TRUE(gate_.begin_homing(0, now_)); }
  /// `way`: of joint 0 in a cycle.
  void home(int cycles, double way = 0.0004) {
    for (int i = 0; i < cycles; ++i) {
      now_ = now_ + seconds(kDt);
      feedback_[0] = {now_, feedback_[0].position + way, 0, DriveState::homing};
      feedback_[1].time = now_;
      gate_.step(now_, {}, feedback_);
    }
  }
  void expect_stopped(GateReason reason, int joint) {
    EXPECT_EQ(gate_.status().state, GateState::stopped);
    EXPECT_EQ(gate_.status().reason, reason) << to_string(gate_.status().reason);
    EXPECT_EQ(gate_.status().joint, joint);
    EXPECT_TRUE(gate_.wants_quick_stop()) << "only its drive can stop it";
    EXPECT_FALSE(gate_.has_set_point(0));
  }
};

TEST_F(HomingGateTest, ItMayMoveAndGetANewZero) {
  home(500);
  home(1, -1.5);
  home(10, 0);
  EXPECT_EQ(gate_.status().state, GateState::homing) << to_string(gate_.status().reason);
  gate_.end_homing(feedback_[0], now_);
  EXPECT_EQ(gate_.status().state, GateState::idle);
  EXPECT_EQ(gate_.set_point(0).position, feedback_[0].position);
  EXPECT_TRUE(gate_.has_set_point(0));
}

TEST_F(HomingGateTest, FollowsNobody) {
  for (int i = 0; i < 10; ++i) cycle(command(1, 1, i >= 5), false);
  EXPECT_EQ(gate_.status().state, GateState::homing);
  EXPECT_EQ(gate_.set_point(1).position, 0);
  EXPECT_FALSE(gate_.reset(feedback_, now_));
}

TEST_F(HomingGateTest, ItsOwnFaultStops) {
  home(100);
  feedback_[0].state = DriveState::fault;
  gate_.step(now_, {}, feedback_);
  expect_stopped(GateReason::drive_fault, 0);
}

TEST_F(HomingGateTest, AFaultOfAnotherDriveStops) {
  home(100);
  feedback_[1].state = DriveState::fault;
  gate_.step(now_, {}, feedback_);
  expect_stopped(GateReason::drive_fault, 1);
}

TEST_F(HomingGateTest, AnotherJointThatIsPushedAwayStops) {
  home(100);
  feedback_[1].position = 0.3;
  home(1);
  expect_stopped(GateReason::following_error, 1);
}

TEST_F(HomingGateTest, ABusFaultStops) {
  home(100);
  gate_.bus_fault("bus-off");
  expect_stopped(GateReason::bus_fault, -1);
}

TEST_F(HomingGateTest, AnEmergencyStopIsTheDrivesToFollow) {
  home(100);
  gate_.emergency_stop();
  expect_stopped(GateReason::emergency_stop, -1);
}

TEST_F(HomingGateTest, OldFeedbackStops) {
  home(100);
  now_ = now_ + seconds(0.06);
  gate_.step(now_, {}, feedback_);
  expect_stopped(GateReason::feedback_lost, 0);
}

TEST_F(HomingGateTest, AJointThatDoesNotMoveStops) {
  home(100);
  home(260, 0);
  expect_stopped(GateReason::feedback_frozen, 0);
}

TEST_F(HomingGateTest, PositionsThatJumpAboutStop) {
  home(100);
  home(1, 3);
  EXPECT_EQ(gate_.status().state, GateState::homing) << "its new zero";
  home(1, -3);
  expect_stopped(GateReason::feedback_jumps, 0);
}

TEST_F(HomingGateTest, ADriveThatLeavesHomingStops) {
  home(100);
  feedback_[0].state = DriveState::stopping;
  gate_.step(now_, {}, feedback_);
  expect_stopped(GateReason::drive_not_enabled, 0);
}

}  // namespace
}  // namespace foresight::homing_gate_test

// The robot's phases, with drives that answer at once.
#include "drivers/robot/robot.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "tests/robot/robot_fixture.hpp"

namespace foresight::robot_test {
namespace {

using namespace std::chrono_literals;

TEST_F(RobotTest, MovesNothingBeforeItIsEnabled) {
  command(1, 0, false);
  run(2);
  for (int i = 0; i < 100; ++i) {
    command(1, 0);
    run(1);
  }
  EXPECT_EQ(robot_.status().phase, RobotPhase::disabled);
  EXPECT_TRUE(drives_[0].requests.empty());
  EXPECT_EQ(drives_[0].state.position, 0);
}

TEST_F(RobotTest, MovesNothingBeforeAllJointsAreHomed) {
  drives_[1].state.homed = false;
  make_ready();
  command(1, 0, false);
  run(1);
  EXPECT_STREQ(robot_.status().refused, "") << "with an open switch nobody asks to move anything";
  for (int i = 0; i < 100; ++i) {
    command(1, 0);
    run(1);
  }
  EXPECT_EQ(drives_[0].state.position, 0);
  EXPECT_STRNE(robot_.status().refused, "");
}

TEST_F(RobotTest, FollowsOnceEnabled) {
  get_moving();
  for (int i = 0; i < 1000; ++i) {
    command(1.9, 0.05);
    run(1);
  }
  EXPECT_NEAR(drives_[0].state.position, 1.9, 1e-3);
  EXPECT_NEAR(drives_[1].state.position, 0.05, 1e-3);
}

TEST_F(RobotTest, AFaultStopsAllButTheGripAndLatches) {
  get_moving();
  const double grip = drives_[1].state.position;
  drives_[0].state.state = DriveState::fault;
  drives_[0].state.fault = "overcurrent";
  run(100);
  EXPECT_EQ(robot_.status().phase, RobotPhase::stopped);
  EXPECT_EQ(robot_.status().gate.reason, GateReason::drive_fault);
  EXPECT_TRUE(drives_[0].asked(DriveRequest::quick_stop));
  EXPECT_FALSE(drives_[1].asked(DriveRequest::quick_stop));
  EXPECT_FALSE(drives_[1].asked(DriveRequest::disable));
  EXPECT_NEAR(drives_[1].state.position, grip, 0.005) << "it holds what it holds";
  robot_.ask(RobotRequest::reset);
  run(5);
  EXPECT_EQ(robot_.status().phase, RobotPhase::ready);
  const double stood = drives_[0].state.position;
  command(-1, 0);
  run(10);
  EXPECT_EQ(drives_[0].state.position, stood) << "the operator must engage again";
}

TEST_F(RobotTest, AnEmergencyStopBrakesAlongSetPoints) {
  get_moving();
  robot_.ask(RobotRequest::emergency_stop);
  robot_.ask(RobotRequest::enable);
  run(1);
  EXPECT_EQ(robot_.status().phase, RobotPhase::stopped);
  const double before = drives_[0].state.position;
  run(300);
  EXPECT_GT(drives_[0].state.position, before) << "it slows down, it does not jerk";
  EXPECT_EQ(robot_.status().set_point[0].velocity, 0);
}

TEST_F(RobotTest, AStopSaysThatNoCyclesCameBeforeIt) {
  make_ready();
  now_ = now_ + std::chrono::seconds(5);
  run(10);
  EXPECT_EQ(robot_.status().stood_still, Duration{}) << "nothing came of it";
  drives_[0].state.state = DriveState::fault;
  run(1);
  ASSERT_EQ(robot_.status().phase, RobotPhase::stopped);
  EXPECT_NEAR(to_seconds(robot_.status().stood_still), 5, 0.01);
}

TEST_F(RobotTest, AStopLongAfterwardsHasAnotherCause) {
  make_ready();
  now_ = now_ + std::chrono::seconds(5);
  run(300);
  drives_[0].state.state = DriveState::fault;
  run(1);
  ASSERT_EQ(robot_.status().phase, RobotPhase::stopped);
  EXPECT_EQ(robot_.status().stood_still, Duration{});
}

TEST_F(RobotTest, ABusThatFailsStops) {
  get_moving();
  network_.fault = "bus-off";
  run(1);
  EXPECT_EQ(robot_.status().phase, RobotPhase::stopped);
  EXPECT_EQ(robot_.status().gate.reason, GateReason::bus_fault);
  EXPECT_STREQ(robot_.status().gate.detail, "bus-off");
}

TEST_F(RobotTest, HomesOnlyWithConsentAndOnlyWhileNobodyIsInCharge) {
  for (PromptDrive& drive : drives_) drive.state.homed = false;
  make_ready();
  run(100);
  EXPECT_FALSE(drives_[0].asked(DriveRequest::home));
  robot_.ask(RobotRequest::home);
  run(200);
  EXPECT_TRUE(robot_.status().all_homed);
  EXPECT_EQ(robot_.status().phase, RobotPhase::ready);
  command(0, 0, false);
  run(1);
  command(1, 0);
  run(1);
  drives_[0].requests.clear();
  robot_.ask(RobotRequest::home);
  run(1);
  EXPECT_STRNE(robot_.status().refused, "");
  EXPECT_FALSE(drives_[0].asked(DriveRequest::home));
}

TEST_F(RobotTest, HomesOnlyJointsThatDoNotKnowWhereTheyAre) {
  drives_[1].state.homed = false;
  make_ready();
  robot_.ask(RobotRequest::home);
  run(100);
  EXPECT_FALSE(drives_[0].asked(DriveRequest::home));
  EXPECT_TRUE(drives_[1].asked(DriveRequest::home));
  EXPECT_EQ(robot_.status().phase, RobotPhase::ready);
  EXPECT_TRUE(robot_.status().all_homed);
}

TEST_F(RobotTest, WhereAllAreHomedItStaysReadyAndSaysSo) {
  make_ready();
  robot_.ask(RobotRequest::home);
  run(1);
  EXPECT_EQ(robot_.status().phase, RobotPhase::ready);
  EXPECT_STREQ(robot_.status().refused, "home: all joints know where they are");
  for (const PromptDrive& drive : drives_) EXPECT_FALSE(drive.asked(DriveRequest::home));
}

TEST_F(RobotTest, ADriveThatIsNeverEnabledIsNamed) {
  drives_[1].stuck = true;
  robot_.ask(RobotRequest::enable);
  run(1300);
  EXPECT_EQ(robot_.status().phase, RobotPhase::stopped);
  EXPECT_EQ(robot_.status().waiting_for, 1);
  EXPECT_EQ(robot_.status().gate.reason, GateReason::not_enabled_in_time);
  EXPECT_EQ(robot_.status().gate.joint, 1);
}

TEST_F(RobotTest, FaultsFromBeforeAreClearedThoughADriveTellsItsLater) {
  drives_[0].state.state = DriveState::fault;
  drives_[1].state.state = DriveState::stopping;  // its first answers are still on the way
  drives_[1].stuck = true;
  robot_.ask(RobotRequest::enable);
  run(3);
  drives_[1].state.state = DriveState::fault;
  drives_[1].stuck = false;
  run(40);
  EXPECT_EQ(robot_.status().phase, RobotPhase::ready);
}

TEST_F(RobotTest, AFaultThatComesBackIsNotClearedAgainAndAgain) {
  drives_[0].state.state = DriveState::fault;
  drives_[0].stuck = true;
  robot_.ask(RobotRequest::enable);
  run(1500);
  EXPECT_EQ(robot_.status().phase, RobotPhase::stopped);
  EXPECT_EQ(std::count(drives_[0].requests.begin(), drives_[0].requests.end(), DriveRequest::reset_fault), 1);
  EXPECT_FALSE(drives_[1].asked(DriveRequest::enable));
}

TEST_F(RobotTest, RunStopsUnderControlAtTheEnd) {
  SteppedClock clock;
  now_ = clock.now();
  std::stop_source stop;
  clock.every(4ms, [&](RobotTime now) {
    now_ = now;
    if (now.ns == 40'000'000) robot_.ask(RobotRequest::enable);
    if (now.ns > 100'000'000) command(1.9, 0, now.ns > 200'000'000);
    if (now.ns == 1'000'000'000) stop.request_stop();
  });
  robot_.run(clock, stop.get_token());
  EXPECT_GT(drives_[0].state.position, 0.3);
  EXPECT_EQ(robot_.status().set_point[0].velocity, 0);
  EXPECT_EQ(drives_[0].state.state, DriveState::disabled);
  EXPECT_EQ(drives_[1].state.state, DriveState::enabled) << "the grip";
  EXPECT_GT(robot_.status().loop.cycles(), 200u);
  EXPECT_EQ(robot_.status().loop.overruns(), 0u);
}

TEST_F(RobotTest, AResetOfTheSameCycleDoesNotUndoAnEmergencyStop) {
  for (const bool stop_first : {true, false}) {
    make_ready();
    run(100);  // at rest: a reset would be followed at once
    if (stop_first) robot_.ask(RobotRequest::emergency_stop, 2);
    robot_.ask(RobotRequest::reset, 1);
    if (!stop_first) robot_.ask(RobotRequest::emergency_stop, 2);
    run(10);
    EXPECT_EQ(robot_.status().phase, RobotPhase::stopped) << stop_first;
    EXPECT_EQ(robot_.status().last_request.what, RobotRequest::emergency_stop);
    EXPECT_EQ(robot_.status().last_request.operator_id, 2u);
    EXPECT_STRNE(robot_.status().refused, "") << "the reset was dropped";
    robot_.ask(RobotRequest::reset);
    run(5);
    EXPECT_EQ(robot_.status().phase, RobotPhase::ready) << "who has seen the stop may reset it";
    robot_.ask(RobotRequest::disable);
    run(3);
    ASSERT_EQ(robot_.status().phase, RobotPhase::disabled);
  }
}

TEST_F(RobotTest, RequestsAreFollowedInTheirOrder) {
  make_ready();
  run(100);
  robot_.ask(RobotRequest::disable, 1);
  robot_.ask(RobotRequest::enable, 2);
  run(1);
  EXPECT_EQ(robot_.status().phase, RobotPhase::disabled);
  EXPECT_EQ(robot_.status().last_request.operator_id, 1u);
  run(3);
  EXPECT_EQ(robot_.status().phase, RobotPhase::ready);
  EXPECT_EQ(robot_.status().last_request.operator_id, 2u);
}

// A shaft that coasts on while set-points stand still.
TEST_F(RobotTest, NothingIsDisabledOrResetBeforeTheShaftsRest) {
  make_ready();
  run(100);
  drives_[0].coast = 1e-4;
  run(10);
  robot_.ask(RobotRequest::disable);
  run(1);
  EXPECT_EQ(robot_.status().phase, RobotPhase::ready);
  EXPECT_THAT(robot_.status().refused, testing::HasSubstr("rest"));
  EXPECT_FALSE(drives_[0].asked(DriveRequest::disable));
  robot_.ask(RobotRequest::emergency_stop);
  run(5);
  robot_.ask(RobotRequest::reset);
  run(1);
  EXPECT_EQ(robot_.status().phase, RobotPhase::stopped);
  drives_[0].coast = 0;
  run(50);
  robot_.ask(RobotRequest::disable);
  run(1);
  EXPECT_EQ(robot_.status().phase, RobotPhase::disabled);
}

TEST_F(RobotTest, AFaultWhileItBrakesStopsTheDrivesToo) {
  get_moving();
  robot_.ask(RobotRequest::emergency_stop);
  run(5);
  ASSERT_FALSE(drives_[0].asked(DriveRequest::quick_stop)) << "it brakes along set-points";
  drives_[1].state.state = DriveState::fault;
  run(2);
  EXPECT_TRUE(drives_[0].asked(DriveRequest::quick_stop));
}

class HomingRobotTest : public RobotTest {
 protected:
  void SetUp() override {
    for (PromptDrive& drive : drives_) {
      drive.state.homed = false;
      drive.homes_slowly = true;
    }
    drives_[1].state.position = 0.05;
    make_ready();
    robot_.ask(RobotRequest::home);
    move(0);
  }
  /// Joint i on its way.
  void move(std::size_t i) {
    run(2);
    ASSERT_EQ(drives_[i].state.state, DriveState::homing);
    drives_[i].coast = 1e-4;
    run(100);
    ASSERT_EQ(robot_.status().phase, RobotPhase::homing) << to_string(robot_.status().gate.reason);
    ASSERT_EQ(robot_.status().waiting_for, static_cast<int>(i));
  }
  void arrive(std::size_t i) {
    drives_[i].coast = 0;
    drives_[i].state.homed = true;
    drives_[i].state.state = DriveState::enabled;
  }
};

TEST_F(HomingRobotTest, EndsReadyWithAllHomed) {
  arrive(0);
  move(1);
  arrive(1);
  run(5);
  EXPECT_EQ(robot_.status().phase, RobotPhase::ready);
  EXPECT_TRUE(robot_.status().all_homed);
}

TEST_F(HomingRobotTest, WhatWasRefusedMeanwhileIsOverOnceItIsReady) {
  robot_.ask(RobotRequest::home);
  run(1);
  EXPECT_THAT(robot_.status().refused, testing::HasSubstr("already"));
  arrive(0);
  move(1);
  EXPECT_THAT(robot_.status().refused, testing::HasSubstr("already"));
  arrive(1);
  run(5);
  ASSERT_EQ(robot_.status().phase, RobotPhase::ready);
  EXPECT_STREQ(robot_.status().refused, "");
}

TEST_F(HomingRobotTest, AFaultOfAnotherDriveStopsIt) {
  drives_[1].state.state = DriveState::fault;
  run(1);
  EXPECT_EQ(robot_.status().phase, RobotPhase::stopped);
  EXPECT_EQ(robot_.status().waiting_for, 0);
  EXPECT_TRUE(drives_[0].asked(DriveRequest::quick_stop));
}

TEST_F(HomingRobotTest, ABusFaultStopsIt) {
  network_.fault = "bus-off";
  run(1);
  EXPECT_EQ(robot_.status().phase, RobotPhase::stopped);
  EXPECT_TRUE(drives_[0].asked(DriveRequest::quick_stop));
}

TEST_F(HomingRobotTest, AGripperThatHomesIsStoppedLikeAllOthers) {
  arrive(0);
  move(1);
  drives_[0].state.state = DriveState::fault;
  run(1);
  EXPECT_TRUE(drives_[1].asked(DriveRequest::quick_stop));
}

TEST_F(HomingRobotTest, DisableIsRefused) {
  robot_.ask(RobotRequest::disable);
  run(1);
  EXPECT_EQ(robot_.status().phase, RobotPhase::homing);
  EXPECT_THAT(robot_.status().refused, testing::HasSubstr("rest"));
  EXPECT_FALSE(drives_[0].asked(DriveRequest::disable));
}

TEST_F(RobotTest, EveryCycleIsHandedOutToEveryReader) {
  auto quick = robot_.cycles(), slow = robot_.cycles();
  make_ready();
  command(0, 0.05, false);
  run(1);
  std::uint64_t last = 0;
  while (const auto cycle = quick.take()) last = cycle->number;
  EXPECT_EQ(last, 4u);
  RobotTime before = now_;
  for (int i = 0; i < 300; ++i) {
    command(1.9, 0.05);
    run(1);
    const auto cycle = quick.take();
    ASSERT_TRUE(cycle && !quick.take());
    EXPECT_EQ(cycle->number, ++last);
    EXPECT_EQ(cycle->time, before + 4ms);
    EXPECT_EQ(cycle->joints, 2u);
    EXPECT_EQ(cycle->joint[0].time, drives_[0].state.time);
    EXPECT_EQ(cycle->joint[0].set_point.position, robot_.status().set_point[0].position);
    before = now_;
  }
  EXPECT_EQ(robot_.status().gate.state, GateState::following);
  run(static_cast<int>(kCyclesKept));
  std::uint64_t taken = 0;
  while (slow.take()) ++taken;
  EXPECT_EQ(taken, kCyclesKept);
  EXPECT_EQ(slow.dropped(), 304u);
  EXPECT_EQ(quick.dropped(), 0u);
}

TEST(LoopStatistics, CountsLatenessAndOverruns) {
  LoopStatistics loop;
  for (int i = 0; i < 990; ++i) loop.count(50us, 4ms);
  for (int i = 0; i < 10; ++i) loop.count(5ms, 4ms);
  EXPECT_EQ(loop.cycles(), 1000u);
  EXPECT_EQ(loop.overruns(), 10u);
  EXPECT_EQ(loop.worst(), 5ms);
  EXPECT_NEAR(static_cast<double>(loop.quantile(0.5).count()), 50e3, 6e3);
  EXPECT_EQ(loop.quantile(0.999), 5ms);
}

}  // namespace
}  // namespace foresight::robot_test

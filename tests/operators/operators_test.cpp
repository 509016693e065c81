#include "operators/follow_operator.hpp"
#include "operators/key_operator.hpp"
#include "operators/line_operator.hpp"
#include "operators/station_operator.hpp"
#include "operators/who_stopped.hpp"
#include "tests/robot/prompt_drive.hpp"
#include "tests/scene/test_run.hpp"
#include "tests/support/folders.hpp"

namespace foresight::operators_test {
namespace {

using namespace std::chrono_literals;

class OperatorsTest : public testing::Test {
 protected:
  OperatorsTest() { make_robot(); }
  void make_robot() {
    std::vector<Drive*> drives;
    for (PromptDrive& drive : drives_) drives.push_back(&drive);
    robot_ = std::make_unique<Robot>(rig_.gate_options(), shape_.get(), std::vector<DriveNetwork*>{&network_}, drives);
  }
  /// 10 ms of the operator's, two and a half cycles of the robot's.
  bool tick(std::initializer_list<Commander*> who) {
    const bool goes_on = serve({who.begin(), who.size()}, *robot_, now_);
    for (int i = 0; i < 5; ++i) {
      now_ = now_ + 2ms;
      if (now_.ns / 2'000'000 % 2 == 0) robot_->cycle(now_);
    }
    return goes_on;
  }
  Rig rig_ = read_rig(source_folder() / "configs/minerva.yaml");
  std::vector<PromptDrive> drives_{std::vector<PromptDrive>(rig_.joints.size())};
  PromptNetwork network_{drives_};
  std::unique_ptr<RobotShape> shape_;  // null: nothing is in the way
  std::unique_ptr<Robot> robot_;
  RobotTime now_{1'000'000'000};
  TempFolder folder_;
};

class FollowOperatorTest : public OperatorsTest {
 protected:
  std::string follow(bool may_home, const std::function<void()>& meanwhile = {},
                     const std::string& motion = "time_s,elbow,finger\n0,0.5,0\n2,1.0,0.02\n") {
    FollowOperator who(FollowFile(folder_.write("m.csv", motion), rig_), may_home);
    for (int i = 0; i < 3000; ++i) {
      if (!tick({&who})) break;
      highest_ = std::max(highest_, drives_[3].state.position);
      if (meanwhile) meanwhile();
    }
    return who.outcome();
  }
  double highest_ = 0;
};

TEST_F(FollowOperatorTest, HomesOnlyWithConsent) {
  EXPECT_THAT(follow(false), testing::HasSubstr("--home"));
  EXPECT_FALSE(drives_[0].asked(DriveRequest::home));
  EXPECT_EQ(highest_, 0);
}

TEST_F(FollowOperatorTest, FollowsTheFileAndEnds) {
  EXPECT_EQ(follow(true), "done");
  EXPECT_NEAR(drives_[3].state.position, 1, 1e-3);
  EXPECT_NEAR(drives_[7].state.position, 0.02, 1e-3);
  EXPECT_EQ(robot_->status().gate.state, GateState::idle);
}

TEST_F(FollowOperatorTest, SaysWhyItWasStopped) {
  const std::string outcome = follow(true, [&] {
    if (drives_[3].state.position < 0.6) return;
    drives_[3].state.state = DriveState::fault;
    drives_[3].state.fault = "overcurrent";
  });
  EXPECT_THAT(outcome, testing::AllOf(testing::HasSubstr("fault"), testing::HasSubstr("overcurrent")));
  EXPECT_LT(highest_, 0.9);
}

// All are stopped with it, and another one may have a longer way to go.
TEST_F(FollowOperatorTest, BlamesTheJointThatFailed) {
  const std::string outcome = follow(
      true,
      [&] {
        if (drives_[1].state.position < 0.2) return;
        drives_[1].state.state = DriveState::fault;
      },
      "time_s,shoulder_pitch,elbow\n0,0,0\n2,0.5,1.5\n");
  EXPECT_THAT(outcome, testing::HasSubstr("not reached: joint shoulder_pitch stands at"));
  EXPECT_THAT(outcome, testing::Not(testing::HasSubstr("elbow")));
}

TEST_F(FollowOperatorTest, WhatTheGateHoldsBackIsNotReached) {
  shape_ = rig_.shape();
  make_robot();
  // Down to the table, and there the file ends.
  const std::string outcome = follow(true, {}, "time_s,shoulder_pitch,elbow\n0,0,0\n4,1.9,1.2\n5,1.9,1.2\n");
  const double stands = drives_[1].state.position;
  EXPECT_LT(stands, 1.85);
  EXPECT_THAT(outcome, testing::StartsWith("not reached: joint "));
  EXPECT_THAT(outcome,
              testing::ContainsRegex("stands at [0-9.]+ rad and should be at 1\\.[0-9]+ rad since [0-9.]+ s of "
                                     "the file: link '[a-z_0-9]+' comes too close to obstacle 'table' "
                                     "\\([0-9.]+ mm apart, 20.0 mm are kept\\)"));
}

TEST_F(FollowOperatorTest, AWayThatIsHeldBackIsNotFollowedThoughItsEndIsReached) {
  shape_ = rig_.shape();
  make_robot();
  const std::string outcome = follow(true, {}, "time_s,shoulder_pitch,elbow\n0,0,0\n4,1.9,1.2\n5,1.9,1.2\n9,0,0\n");
  EXPECT_NEAR(drives_[1].state.position, 0, 1e-3);
  EXPECT_THAT(outcome, testing::StartsWith("not followed: held back since "));
  EXPECT_THAT(outcome, testing::AllOf(testing::HasSubstr("by up to"), testing::HasSubstr("obstacle 'table'"),
                                      testing::HasSubstr("end of the file was reached")));
}

// At the largest velocity from the first row on, where the ramp allows a tenth of it: late, but there.
TEST_F(FollowOperatorTest, WaitsForWhatIsLate) {
  EXPECT_EQ(follow(true, {}, "time_s,elbow\n0,0\n1,1.2\n"), "done");
  EXPECT_NEAR(drives_[3].state.position, 1.2, 1e-3);
}

// As where this program's own threads came too late: what is left of the file is not followed, and that is no success.
TEST_F(FollowOperatorTest, IsNotDoneWhereTheRobotLostIt) {
  const std::string outcome = follow(true, [&] {
    if (drives_[3].state.position < 0.6) return;
    for (int i = 0; i < 50; ++i) robot_->cycle(now_ = now_ + 4ms);
  });
  EXPECT_THAT(outcome,
              testing::AllOf(testing::HasSubstr("stopped"), testing::HasSubstr("lost"),
                             testing::HasSubstr("joint elbow stands at"), testing::HasSubstr("s of the file")));
}

class StationOperatorTest : public OperatorsTest {
 protected:
  /// Until it waits, or gives up.
  void go_on(int most_ticks = 4000) {
    for (int i = 0; i < most_ticks && tick({&who_}) && !who_.waiting(); ++i) {
    }
  }
  JointValues at(double elbow) const {
    JointValues positions{};
    for (std::size_t i = 0; i < rig_.joints.size(); ++i) positions[i] = drives_[i].state.position;
    positions[3] = elbow;
    return positions;
  }
  StationOperator who_{rig_.joint_words(), true};
};

TEST_F(StationOperatorTest, LetsGoAndHoldsStillAtEachStation) {
  go_on();
  ASSERT_TRUE(who_.waiting()) << who_.failure();
  for (const double elbow : {0.4, -0.2}) {
    who_.go_to(at(elbow));
    EXPECT_FALSE(who_.waiting());
    go_on();
    ASSERT_TRUE(who_.waiting()) << who_.failure();
    EXPECT_EQ(who_.missed(), "");
    EXPECT_NEAR(drives_[3].state.position, elbow, 1e-3);
    EXPECT_EQ(robot_->status().gate.state, GateState::idle) << "nobody drives while somebody looks";
    EXPECT_GE(to_seconds(now_ - who_.still_since()), 0.29);
  }
  who_.finish();
  EXPECT_FALSE(tick({&who_}));
}

TEST_F(StationOperatorTest, SaysWhatItWasKeptFrom) {
  go_on();
  who_.go_to(at(9));  // beyond the joint
  go_on();
  ASSERT_TRUE(who_.waiting()) << who_.failure();
  EXPECT_NE(who_.missed(), "");
  EXPECT_NEAR(drives_[3].state.position, 0, 1e-3);
  who_.go_to(at(0.3));
  go_on();
  EXPECT_EQ(who_.missed(), "");
  EXPECT_NEAR(drives_[3].state.position, 0.3, 1e-3);
}

TEST_F(StationOperatorTest, EndsWhereTheRobotStopsOrMayNotHome) {
  go_on();
  who_.go_to(at(1));
  for (int i = 0; i < 60; ++i) tick({&who_});
  robot_->ask(RobotRequest::emergency_stop);
  go_on();
  EXPECT_THAT(who_.failure(), testing::HasSubstr("stopped"));
  StationOperator other(rig_.joint_words(), false);
  for (PromptDrive& drive : drives_) drive.state.homed = false;
  for (int i = 0; i < 3000 && tick({&other}); ++i) {
  }
  EXPECT_NE(other.failure(), "");
}

TEST_F(StationOperatorTest, EndsWhereTheRobotStopsAtTheLastStation) {
  go_on();
  who_.go_to(at(1));
  for (int i = 0; i < 60; ++i) tick({&who_});
  who_.finish();
  robot_->ask(RobotRequest::emergency_stop);
  bool goes_on = true;
  for (int i = 0; i < 1000 && goes_on; ++i) goes_on = tick({&who_});
  EXPECT_FALSE(goes_on) << "nobody is in charge of a robot that has stopped";
}

class KeyOperatorTest : public OperatorsTest {
 protected:
  void type(const std::string& keys, int ticks = 1) {
    who_.press(keys);
    for (int i = 0; i < ticks; ++i) tick({&who_});
  }
  KeyOperatorTest() {
    for (PromptDrive& drive : drives_) drive.state.homed = true;
  }
  KeyOperator who_{rig_.gate_options().joints};
};

TEST_F(KeyOperatorTest, MovesTheSelectedJointWhileTheKeyRepeats) {
  type("e", 10);
  ASSERT_EQ(robot_->status().phase, RobotPhase::ready);
  type("4", 10);
  for (int i = 0; i < 100; ++i) type("+");
  const double there = drives_[3].state.position;
  EXPECT_GT(there, 0.01);
  EXPECT_EQ(drives_[2].state.position, 0);
  type("", 200);
  EXPECT_EQ(robot_->status().gate.state, GateState::idle) << "released";
  EXPECT_LT(drives_[3].state.position, there + 0.3);
  for (int i = 0; i < 300; ++i) type("-");
  EXPECT_LT(drives_[3].state.position, there);
}

TEST_F(KeyOperatorTest, SpaceStopsWhateverElseIsTyped) {
  type("e", 10);
  for (int i = 0; i < 100; ++i) type("+");
  type("e re", 2);
  EXPECT_EQ(robot_->status().phase, RobotPhase::stopped);
}

TEST_F(KeyOperatorTest, HomingAsksForConsent) {
  drives_[0].state.homed = false;
  type("e", 10);
  type("h");
  EXPECT_TRUE(who_.asks_for_consent());
  type("n");
  type("y", 5);
  EXPECT_FALSE(drives_[0].asked(DriveRequest::home)) << "the consent was refused before";
  type("h");
  type("y", 5);
  EXPECT_TRUE(drives_[0].asked(DriveRequest::home));
}

TEST_F(KeyOperatorTest, BesideAFileKeysOnlyStopAndQuit) {
  KeyOperator keys(rig_.gate_options().joints, KeyOperator::Rights::only_stops);
  FollowOperator file(FollowFile(folder_.write("m.csv", "time_s,elbow\n0,0.5\n2,1.0\n"), rig_), true);
  for (int i = 0; i < 200; ++i) {
    keys.press("d+");
    ASSERT_TRUE(tick({&file, &keys}));
  }
  EXPECT_EQ(robot_->status().gate.operator_id, FollowOperator::kId);
  EXPECT_EQ(robot_->status().gate.dropped, 0u) << "the keyboard commands nothing";
  keys.press(" ");
  tick({&file, &keys});
  EXPECT_EQ(robot_->status().phase, RobotPhase::stopped);
  EXPECT_EQ(robot_->status().last_request.operator_id, KeyOperator::kId);
  EXPECT_EQ(who_stopped(robot_->status()), "asked for by a key of the robot's console");
  keys.press("q");
  EXPECT_FALSE(tick({&file, &keys}));
}

TEST(WhoStopped, NamesWhoAskedForItOverTheLine) {
  RobotStatus status;
  status.phase = RobotPhase::stopped;
  status.gate.reason = GateReason::emergency_stop;
  status.last_request = {RobotRequest::emergency_stop, LineOperator::kId};
  EXPECT_EQ(who_stopped(status, "anna"), "asked for over the line by 'anna'");
  EXPECT_EQ(name_and_who("stopped", status), "stopped (asked for over the line)") << "where no name is known";
  status.last_request.operator_id = KeyOperator::kId;
  EXPECT_EQ(who_stopped(status, "anna"), "asked for by a key of the robot's console") << "anna did so before";
}

TEST_F(KeyOperatorTest, AnOperatorThatStartsAnewIsHeardAtOnce) {
  type("e", 10);
  for (int i = 0; i < 100; ++i) type("+");
  type("", 200);
  KeyOperator again(rig_.gate_options().joints);
  const double before = drives_[0].state.position;
  for (int i = 0; i < 100; ++i) {
    again.press("+");
    tick({&again});
  }
  EXPECT_EQ(robot_->status().gate.dropped, 0u) << to_string(robot_->status().gate.last_dropped);
  EXPECT_GT(drives_[0].state.position, before);
}

}  // namespace
}  // namespace foresight::operators_test

#include "apps/robot/operators.hpp"

#include "apps/robot/status_view.hpp"
#include "tests/robot/prompt_drive.hpp"
#include "tests/scene/test_run.hpp"
#include "tests/support/folders.hpp"

namespace foresight {
namespace {

using namespace std::chrono_literals;

class OperatorsTest : public testing::Test {
 protected:
  OperatorsTest() {
    std::vector<Drive*> drives;
    for (PromptDrive& drive : drives_) drives.push_back(&drive);
    robot_ = std::make_unique<Robot>(rig_.gate_options(), nullptr, std::vector<DriveNetwork*>{&network_}, drives);
  }
  /// 10 ms of the operator's, two and a half cycles of the robot's.
  template <typename Tick>
  bool tick(Tick&& tick) {
    const OperatorWish wish = tick(now_, robot_->status());
    if (wish.request != RobotRequest::none) robot_->ask(wish.request);
    if (wish.command) robot_->submit(*wish.command);
    for (int i = 0; i < 5; ++i) {
      now_ = now_ + 2ms;
      if (now_.ns / 2'000'000 % 2 == 0) robot_->cycle(now_);
    }
    return !wish.quit;
  }
  Rig rig_ = read_rig(source_folder() / "configs/minerva.yaml");
  std::vector<PromptDrive> drives_{std::vector<PromptDrive>(rig_.joints.size())};
  PromptNetwork network_{drives_};
  std::unique_ptr<Robot> robot_;
  RobotTime now_{1'000'000'000};
  TempFolder folder_;
};

class FollowOperatorTest : public OperatorsTest {
 protected:
  std::string follow(bool may_home, const std::function<void()>& meanwhile = {}) {
    FollowOperator who(FollowFile(folder_.write("m.csv", "time_s,elbow,finger\n0,0.5,0\n2,1.0,0.02\n"), rig_),
                       rig_.joint_names(), may_home);
    for (int i = 0; i < 3000; ++i) {
      if (!tick([&](RobotTime now, const RobotStatus& status) { return who.tick(now, status); })) break;
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

class KeyOperatorTest : public OperatorsTest {
 protected:
  void type(const std::string& keys, int ticks = 1) {
    for (int i = 0; i < ticks; ++i)
      tick([&](RobotTime now, const RobotStatus& status) { return who_.tick(now, status, i == 0 ? keys : ""); });
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

TEST_F(KeyOperatorTest, TheViewShowsWhatAnOperatorMustKnow) {
  type("e", 10);
  drives_[5].state.state = DriveState::fault;
  drives_[5].state.fault = "following error";
  type("", 5);
  const std::string text = status_text(rig_, robot_->status(), {{"can0", CanBusState::bus_off, {}, 0.31}}, 2);
  for (const char* words :
       {"stopped", "the drive reports a fault (wrist_pitch): following error", ">", "bus-off", "31 %", "overruns"})
    EXPECT_THAT(text, testing::HasSubstr(words));
}

}  // namespace
}  // namespace foresight

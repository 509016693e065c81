// From messages of the line to the robot that will be.
#include "seat/robot_outlook.hpp"

#include "link/control/control_words.hpp"
#include "tests/support/folders.hpp"

namespace foresight::outlook_test {
namespace {

using namespace std::chrono_literals;

Rig minerva() {
  return read_rig(source_folder() / "configs" / "minerva.yaml");
}

/// A robot at rest that would follow.
link::GateMotion at_rest(std::size_t joints, RobotTime time, std::uint64_t number) {
  link::GateMotion out;
  out.session = 7;
  out.number = number;
  out.time_ns = time.ns;
  out.doing = static_cast<std::uint8_t>(GateDoing::idle);
  out.speed = 1;
  out.joints.resize(joints);
  for (auto& joint : out.joints) joint.known = true;
  return out;
}

TEST(RobotReport, SaysWhoseSetPointItWas) {
  link::GateMotion motion = at_rest(2, {1'000'000'000}, 1);
  motion.joints[1].known = false;
  motion.joints[0].told_us = 3000;
  EXPECT_EQ(robot_report(motion, 5).newest_set_point, 0u);
  motion.commander = 5;
  motion.set_point = 42;
  motion.set_point_came_ns = 990'000'000;
  const RobotReport ours = robot_report(motion, 5);
  EXPECT_EQ(ours.newest_set_point, 42u);
  EXPECT_EQ(ours.newest_came.ns, 990'000'000);
  EXPECT_EQ(ours.joint[0].time.ns, 997'000'000);
  EXPECT_TRUE(std::isnan(ours.joint[1].position)) << "nobody knows where that joint is";
  EXPECT_NE(robot_report(motion, 6).newest_set_point, 42u) << "a number of somebody else's is none of ours";
  EXPECT_NE(robot_report(motion, 6).newest_set_point, 0u);
}

TEST(RobotReport, MoreJointsThanThereAreDoNoHarm) {
  EXPECT_EQ(robot_report(at_rest(1000, {1}, 1), 5).joints, kMostJoints);
}

class Outlook : public testing::Test {
 protected:
  /// 20 ms of a robot whose reports take 50 ms.
  void step() {
    now_ = now_ + 20ms;
    outlook_.hear(at_rest(rig_.joints.size(), now_ - 50ms, ++number_), 5, now_);
    outlook_.advance(now_);
  }
  Rig rig_ = minerva();
  RobotOutlook outlook_{rig_};
  RobotTime now_{10'000'000'000};
  std::uint64_t number_ = 0;
};

TEST_F(Outlook, ARobotAtRestIsShownWhereItIs) {
  EXPECT_EQ(outlook_.at(now_).status, StateStatus::invalid);
  for (int i = 0; i < 100; ++i) step();
  const PredictedRobot shown = outlook_.show(outlook_.instant_to_show(now_));
  EXPECT_NE(shown.status, StateStatus::invalid) << to_words(shown, rig_.joint_names());
  for (std::size_t i = 0; i < shown.joints; ++i) EXPECT_NEAR(shown.position[i], 0, 1e-9);
  EXPECT_EQ(outlook_.figures().robots, 1u);
  EXPECT_EQ(outlook_.figures().refused, 0u) << outlook_.figures().refusal;
}

/// Of the robot's end of the line, which asks for consent 9.
ControlState told(RobotTime time, Nonce holder, RestCause cause, SetPointFault fault) {
  ControlState out;
  out.sequence = 1;
  out.time = time;
  out.holder = holder;
  out.consent = 9;
  out.cause = cause;
  out.fault = fault;
  return out;
}

// The robot says that it has seen the switch open, or why a press moves nothing: only then it moves.
TEST_F(Outlook, ARobotThatMayNotFollowIsShownAtRest) {
  struct Case {
    Nonce holder = 5, named = 9;
    RestCause cause = RestCause::let_go;
    SetPointFault fault = SetPointFault::none;
    bool moves = false;
  };
  for (const Case& one : {Case{.moves = true}, Case{.cause = RestCause::none, .moves = true},
                          Case{.fault = SetPointFault::expired, .moves = true}, Case{.holder = 4}, Case{.named = 8},
                          Case{.cause = RestCause::granted}, Case{.fault = SetPointFault::not_let_go},
                          Case{.fault = SetPointFault::elsewhere}}) {
    RobotOutlook outlook(rig_);
    SetPoint set_point;
    set_point.consent = one.named;
    set_point.joints = rig_.joints.size();
    set_point.lasts = 300ms;
    set_point.deadman = true;
    set_point.position[0] = 0.3;
    const RobotTime begin = now_;
    for (int i = 0; i < 100; ++i) {
      now_ = now_ + 20ms;
      outlook.hear(told(now_ - 50ms, one.holder, one.cause, one.fault), 5);
      outlook.hear(at_rest(rig_.joints.size(), now_ - 50ms, ++number_), 5, now_);
      ++set_point.sequence;
      // Before, nothing is on its way: what the robot did not answer to for long is known to be refused.
      if (now_ > begin + 1900ms) outlook.sent(set_point, now_);
      outlook.advance(now_);
    }
    const PredictedRobot shown = outlook.at(outlook.instant_to_show(now_));
    ASSERT_NE(shown.status, StateStatus::invalid) << to_words(shown, rig_.joint_names());
    EXPECT_EQ(shown.position[0] > 1e-6, one.moves) << words_for(one.fault).name << ", named " << one.named;
  }
}

TEST_F(Outlook, AnotherStartOfTheRobotsProgramIsAnotherRobot) {
  for (int i = 0; i < 50; ++i) step();
  link::GateMotion other = at_rest(rig_.joints.size(), {1'000'000}, 1);  // its host has just been switched on
  other.session = 8;
  now_ = {60'000'000};
  outlook_.hear(other, 5, now_);
  EXPECT_EQ(outlook_.figures().robots, 2u);
  ASSERT_TRUE(outlook_.newest());
  EXPECT_EQ(outlook_.newest()->time.ns, 1'000'000);
}

TEST_F(Outlook, AReportOfAnotherRigIsRefused) {
  for (int i = 0; i < 50; ++i) step();
  link::GateMotion other = at_rest(3, now_, ++number_);
  outlook_.hear(other, 5, now_);
  EXPECT_EQ(outlook_.figures().refused, 1u);
  EXPECT_NE(outlook_.figures().refusal, "");
}

}  // namespace
}  // namespace foresight::outlook_test

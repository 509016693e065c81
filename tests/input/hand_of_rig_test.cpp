// Which joints of a rig a hand moves.
#include "input/hand_of_rig.hpp"

#include <gmock/gmock.h>

#include <algorithm>

#include "common/error.hpp"
#include "tests/support/folders.hpp"

namespace foresight::hand_of_rig_test {
namespace {

class HandOfRigTest : public testing::Test {
 protected:
  Rig rig_ = read_rig(source_folder() / "configs/minerva.yaml");
};

TEST_F(HandOfRigTest, TheLastLinkThatTheArmMovesIsTheTool) {
  EXPECT_EQ(tool_link(rig_), "arm_7");
  const HandOptions options = hand_options(rig_);
  ASSERT_TRUE(options.arm);
  EXPECT_EQ(options.arm_joints, (std::vector<std::size_t>{0, 1, 2, 3, 4, 5, 6}));
  EXPECT_EQ(options.roles[7], JointRole::gripper);
  EXPECT_EQ(options.roles[8], JointRole::other);
  EXPECT_EQ(options.pan, 8u);
  EXPECT_EQ(options.tilt, 9u);
  for (std::size_t i = 0; i < 7; ++i) {
    EXPECT_LE(options.arm->joints()[i].velocity, options.gate.joints[i].limits.velocity);
    EXPECT_GE(options.arm->joints()[i].lower, options.gate.joints[i].limits.min_position);
    EXPECT_LE(options.arm->joints()[i].upper, options.gate.joints[i].limits.max_position);
  }
  HandControl(options, "minerva");
}

TEST_F(HandOfRigTest, TheToolMayBeBetweenTheFingers) {
  const Pose grip = grip_point(rig_, "arm_7");
  EXPECT_NEAR(grip.translation().x(), 0, 1e-6);
  EXPECT_NEAR(grip.translation().y(), 0, 1e-6) << "both fingers count";
  EXPECT_NEAR(grip.translation().z(), 0.1, 1e-3);
  const HandOptions flange = hand_options(rig_), fingers = hand_options(rig_, "", grip);
  const JointVector q = flange.arm->middle();
  EXPECT_TRUE(fingers.arm->tip_pose(q).isApprox(flange.arm->tip_pose(q) * grip, 1e-12));
  EXPECT_TRUE(grip_point(rig_, "finger_left").isApprox(Pose::Identity())) << "nothing grips beyond it";
}

TEST_F(HandOfRigTest, ALinkThatIsNotThereIsRefusedAndSoIsOneThatTheArmDoesNotReach) {
  EXPECT_THROW(hand_options(rig_, "hand"), InputError);
  const HandOptions finger = hand_options(rig_, "finger_left");
  try {
    HandControl(finger, "minerva");
    FAIL() << "the finger is no joint of the arm";
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), testing::HasSubstr("finger"));
  }
}

TEST_F(HandOfRigTest, ACureIsOneThatTheRigFileHas) {
  const auto refusal = [&] {
    try {
      hand_options(rig_);
    } catch (const InputError& error) {
      return std::string(error.what());
    }
    return std::string("no error");
  };
  UrdfJoint& elbow = *std::ranges::find(rig_.robot->joints, rig_.joints[3].drive.name, &UrdfJoint::name);
  elbow.mimic = UrdfJoint::Mimic{0, 1, 0};
  EXPECT_THAT(refusal(),
              testing::AllOf(testing::HasSubstr("follows another, but lies in the arm"),
                             testing::HasSubstr("another group"), testing::Not(testing::HasSubstr("--tip"))));
  elbow.mimic.reset();
  rig_.joints[3].drive.name = "another";
  EXPECT_THAT(refusal(), testing::AllOf(testing::HasSubstr("add it to the rig's joints"),
                                        testing::Not(testing::HasSubstr("--tip"))));
}

TEST_F(HandOfRigTest, WithoutAModelJointsAreMovedAlone) {
  rig_.robot.reset();
  const HandOptions options = hand_options(rig_);
  EXPECT_FALSE(options.arm);
  EXPECT_EQ(HandControl(options, "minerva").last().mode, HandMode::joints);
}

TEST_F(HandOfRigTest, OptionsThatContradictThemselvesAreRefused) {
  const auto refused = [&](const std::function<void(HandOptions&)>& change) {
    HandOptions options = hand_options(rig_);
    change(options);
    EXPECT_THROW(HandControl(options, "minerva"), InputError);
  };
  refused([](HandOptions& o) { o.roles.pop_back(); });
  refused([](HandOptions& o) { o.arm_joints[2] = 99; });
  refused([](HandOptions& o) { o.arm_joints.pop_back(); });
  refused([](HandOptions& o) { o.gate.joints[3].limits.velocity *= 0.5; });
  refused([](HandOptions& o) { o.leash = 0; });
  refused([](HandOptions& o) { o.joint_speed = std::nan(""); });
}

}  // namespace
}  // namespace foresight::hand_of_rig_test

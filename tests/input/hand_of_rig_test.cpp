// Which joints of a rig a hand moves.
#include "input/hand_of_rig.hpp"

#include <gmock/gmock.h>

#include <algorithm>

#include "common/error.hpp"
#include "rig/rig_draft.hpp"
#include "tests/scene/test_run.hpp"
#include "tests/support/folders.hpp"
#include "tests/support/palletiser.hpp"

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
  rig_.joints[3].drive.name = "another";
  EXPECT_THAT(refusal(), testing::AllOf(testing::HasSubstr("add it to the rig's joints"),
                                        testing::Not(testing::HasSubstr("--tip"))));
}

// The rig that `foresight rig new` makes of a palletising arm.
Rig palletiser(Linkage linkage, bool roll) {
  const TempFolder folder;
  RigDraftOptions options;
  options.urdf = folder.write("arm.urdf", palletiser_urdf(linkage, roll));
  return read_rig(folder.write("rig.yaml", rig_text(draft_rig(options), options, folder / "rig.yaml")));
}

TEST(PalletiserHand, ItsDrivesAreTheArmAndItsLastLinkTheTool) {
  for (const Linkage linkage :
       {Linkage::forearm_by_rods, Linkage::at_the_wrist, Linkage::by_lever, Linkage::in_two_halves})
    for (const bool roll : {true, false}) {
      const Rig rig = palletiser(linkage, roll);
      EXPECT_EQ(tool_link(rig), roll ? "hand" : "wrist");
      const HandOptions options = hand_options(rig);
      ASSERT_TRUE(options.arm);
      EXPECT_EQ(rig.robot->links[options.tip].name, roll ? "hand" : "wrist");
      EXPECT_EQ(options.arm->size(), roll ? 4u : 3u);
      for (std::size_t i = 0; i < options.arm->size(); ++i)
        EXPECT_EQ(options.arm->joints()[i].name, rig.joints[options.arm_joints[i]].drive.name);
      HandControl(options, "palletiser");
    }
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

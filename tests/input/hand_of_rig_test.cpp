// Which joints of a rig a hand moves.
#include "input/hand_of_rig.hpp"

#include <gmock/gmock.h>

#include <algorithm>

#include "common/error.hpp"
#include "rig/rig_draft.hpp"
#include "tests/input/hand_world.hpp"
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

// An operator's hand at a robot that does at once what it is told.
class Operated {
 public:
  explicit Operated(const Rig& rig) : options_(hand_options(rig)), hand_(options_, "palletiser") {
    hand_.settings().frame = HandFrame::base;
    for (std::size_t i = 0; i < options_.gate.joints.size(); ++i)
      at_[i] = 0.5 * (options_.gate.joints[i].limits.min_position + options_.gate.joints[i].limits.max_position);
    stay(50, false);
    stay(300, true);
  }
  const HandCycle& stay(int cycles, bool held) {
    for (int i = 0; i < cycles; ++i) {
      now_ = now_ + std::chrono::milliseconds(8);
      HandInput input;
      input.now = now_;
      input.device = device_at(place_.translation(), held);
      input.device.T_space_hand = place_;
      input.device.time = now_;
      input.robot = {options_.gate.joints.size(), at_, true, held, false};
      const HandCycle& cycle = hand_.cycle(input);
      if (cycle.joints > 0) at_ = cycle.positions;
    }
    return hand_.last();
  }
  /// There evenly in 4 s.
  const HandCycle& go(const Eigen::Vector3d& way, const Eigen::AngleAxisd& turn) {
    const Pose from = place_;
    Pose to = from;
    to.translation() += way;
    to.linear() = turn.toRotationMatrix() * from.linear();
    for (int i = 1; i <= 500; ++i) {
      place_ = pose_between(from, to, i / 500.0);
      stay(1, true);
    }
    return stay(100, true);
  }

 private:
  HandOptions options_;
  HandControl hand_;
  OperatorTime now_{1'000'000'000};
  JointValues at_{};
  Pose place_ = Pose::Identity();
};

TEST(PalletiserHand, GoesWhereTheOperatorsHandGoesHoweverThatIsTilted) {
  for (const Linkage linkage : {Linkage::forearm_by_rods, Linkage::at_the_wrist, Linkage::by_lever}) {
    Operated operated(palletiser(linkage, true));
    const Pose begin = operated.stay(1, true).T_base_tip;
    const auto off = [&](const HandCycle& cycle, const Eigen::Vector3d& way, double turn) {
      Pose there = begin;
      there.translation() += way;
      there.linear() = Eigen::AngleAxisd(turn, Eigen::Vector3d::UnitZ()) * begin.linear();
      return pose_difference(cycle.T_base_tip, there).norm();
    };
    const HandCycle turned = operated.go({-0.1, 0.1, 0.05}, Eigen::AngleAxisd(0.5, Eigen::Vector3d::UnitZ()));
    EXPECT_EQ(turned.phase, HandPhase::driving);
    EXPECT_EQ(turned.follow, FollowReason::none) << name_of(turned.follow);
    EXPECT_LT(off(turned, {-0.1, 0.1, 0.05}, 0.5), 1e-6);
    const HandCycle tilted = operated.go({0.05, 0, 0.05}, Eigen::AngleAxisd(1.3, Eigen::Vector3d::UnitX()));
    EXPECT_LT((tilted.T_base_tip.translation() - begin.translation() - Eigen::Vector3d(-0.05, 0.1, 0.1)).norm(), 1e-6);
    EXPECT_NEAR(tilted.rotation_error, 1, 0.01) << "the leash of its turn, which does not hold its place";
    EXPECT_EQ(tilted.follow, FollowReason::few_joints) << name_of(tilted.follow);
    EXPECT_THAT(describe(tilted, {}).name, testing::HasSubstr("too few joints"));
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

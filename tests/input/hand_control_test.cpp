// What users of such systems complain about, and what a hand is for.
#include "input/hand_control.hpp"

#include <gmock/gmock.h>

#include <cmath>

#include "input/keyboard_mouse.hpp"
#include "tests/input/hand_control_fixture.hpp"
#include "tests/support/allocations.hpp"
#include "tests/support/folders.hpp"

namespace foresight::hand_control_test {
namespace {

using namespace std::chrono_literals;
using Eigen::Vector3d;

TEST_F(HandControlTest, TheToolGoesWithTheHand) {
  engage();
  const Vector3d before = tool();
  go({0.05, -0.03, 0.04}, 250);
  stay(100);
  EXPECT_NEAR((tool() - before - Vector3d(0.05, -0.03, 0.04)).norm(), 0, 1e-3);
  EXPECT_NEAR(world_.shaft(3), world_.hand().last().positions[3], 1e-3) << "and the robot's shafts with it";
}

TEST_F(HandControlTest, AStillHandMovesNothingAtAPressNorAtTheNext) {
  for (const bool held : {false, true, false, true, true}) {
    const HandCycle& out = stay(150, held);
    for (std::size_t i = 0; i < out.joints; ++i) EXPECT_EQ(world_.shaft(i), out.positions[i]) << i;
  }
  const JointValues before = world_.hand().last().positions;
  stay(100, true, false);
  EXPECT_EQ(stay(100).positions, before) << "nor at a clutch that is closed again";
  EXPECT_GT(world_.driving, 300);
}

TEST_F(HandControlTest, AHandThatGoesAloneTakesNothingAlong) {
  engage();
  go({0.04, 0, 0}, 100);
  stay(50);
  stay(1, true, false);
  const JointValues before = world_.hand().last().positions;
  go({-0.6, 0.5, 0.3}, 200, true, false);
  EXPECT_EQ(world_.hand().last().phase, HandPhase::holding);
  EXPECT_EQ(stay(100, true, true).positions, before) << "wherever the clutch is closed again";
  const Vector3d tip = tool();
  go(at_ + Vector3d(0, 0, 0.03), 100);
  stay(50);
  EXPECT_NEAR((tool() - tip - Vector3d(0, 0, 0.03)).norm(), 0, 1e-3);
}

TEST_F(HandControlTest, ANoisyFilteredHandThatStopsMovesNothingAtAPress) {
  // Its filter still knows the motion before.
  for (int i = 0; i < 100; ++i) world_.cycle(device_at(Vector3d(0.004 * i, 0.0003 * (i % 3), 0), false));
  at_ = {0.4, 0, 0};
  stay(1, false);
  const JointValues before = stay(1).positions;
  EXPECT_EQ(stay(100).positions, before);
}

TEST_F(HandControlTest, TrackingThatIsLostEndsIt) {
  engage();
  go({0.02, 0, 0}, 50);
  TrackerState lost = device_at({0, 0, 0}, true);
  lost.tracked = false;
  const HandCycle& out = world_.cycle(lost);
  EXPECT_EQ(out.phase, HandPhase::refused);
  EXPECT_FALSE(out.deadman);
  EXPECT_THAT(words(), testing::HasSubstr("not tracked"));
  stay(100);
  EXPECT_EQ(out.phase, HandPhase::refused) << "until the switch was let go of";
  EXPECT_THAT(words(), testing::HasSubstr("not tracked")) << "the reason stays in view";
  stay(60, false);
  EXPECT_EQ(stay(100).phase, HandPhase::driving);
}

TEST_F(HandControlTest, APoseThatJumpsToZeroEndsIt) {
  at_ = {0.5, 0.2, 1};
  engage();
  const JointValues before = world_.hand().last().positions;
  const HandCycle& out = world_.cycle(device_at({0, 0, 0}, true));
  EXPECT_EQ(out.fault, HandFault::jumped);
  EXPECT_FALSE(out.deadman);
  for (std::size_t i = 0; i < 7; ++i) EXPECT_NEAR(out.positions[i], before[i], 1e-6);
}

TEST_F(HandControlTest, WhatIsWrongLaterDoesNotChangeTheReasonThatIsTold) {
  engage();
  TrackerState gone;
  gone.trouble = "the window does not answer";
  gone.cure = "wait";
  world_.cycles(5, gone);
  ASSERT_EQ(words(), "the window does not answer");
  world_.cycle(device_at(at_ + Vector3d(2, 0, 0), true));  // back, elsewhere, its switch still held
  EXPECT_EQ(world_.hand().last().phase, HandPhase::refused);
  EXPECT_EQ(words(), "the window does not answer");
  EXPECT_EQ(describe(world_.hand().last(), world_.joints()).cure, "wait");
  stay(60, false);
  EXPECT_EQ(words(), "");
}

TEST_F(HandControlTest, ADeviceThatFreezesEndsIt) {
  engage();
  TrackerState frozen = device_at(at_, true);
  frozen.time = world_.now();
  for (int i = 0; i < 30; ++i) world_.cycle(frozen, true);
  EXPECT_EQ(world_.hand().last().fault, HandFault::frozen);
  EXPECT_EQ(world_.hand().last().phase, HandPhase::refused);
}

TEST_F(HandControlTest, InstantsOfAnotherClockMoveNothing) {
  TrackerState other = device_at(at_, false);
  for (int i = 0; i < 200; ++i) {
    other.time = {1'700'000'000'000'000'000 + i * 8'000'000};
    other.buttons.set(TrackerButton::deadman, i > 100);
    other.buttons.set(TrackerButton::clutch, i > 100);
    other.T_space_hand.translation().x() = 0.001 * i;
    EXPECT_FALSE(world_.cycle(other, true).deadman);
  }
  EXPECT_THAT(words(), testing::HasSubstr("another clock"));
}

TEST_F(HandControlTest, ADeviceThatComesBackWithItsSwitchHeldIsNotFollowed) {
  engage();
  for (int i = 0; i < 10; ++i) world_.cycle(TrackerState{});
  EXPECT_EQ(world_.hand().last().fault, HandFault::device_gone);
  stay(300);
  EXPECT_EQ(world_.hand().last().phase, HandPhase::refused);
  stay(60, false);
  EXPECT_EQ(stay(60).phase, HandPhase::driving);
}

TEST_F(HandControlTest, ASwitchThatIsHeldFromTheBeginIsNotFollowed) {
  HandWorld world;
  for (int i = 0; i < 20; ++i) world.cycle(TrackerState{});
  for (int i = 0; i < 100; ++i) EXPECT_FALSE(world.cycle(device_at({0, 0, 0}, true)).deadman);
  EXPECT_EQ(world.hand().last().reason, HandReason::not_let_go);
}

TEST_F(HandControlTest, AProgramThatStoodStillDoesNotReturnToAnOldTarget) {
  engage();
  go({0.08, 0, 0}, 20);
  world_.stand_still(400ms);
  stay(1);
  EXPECT_EQ(world_.hand().last().reason, HandReason::paused);
  stay(200);
  const double stood = world_.shaft(3);
  stay(200, false);
  EXPECT_EQ(stay(100).phase, HandPhase::driving) << words();
  EXPECT_EQ(world_.shaft(3), stood) << "it goes on from where the robot stands";
}

TEST_F(HandControlTest, NoTargetOfBeforeIsGoneBackTo) {
  for (const bool lets_go : {false, true}) {
    engage();
    go(at_ + Vector3d(0.25, 0, 0), 25);  // faster than the arm
    ASSERT_GT(world_.hand().last().position_error, 0.03);
    stay(200, !lets_go, false);
    const Vector3d stood = tool();
    stay(250);
    ASSERT_EQ(world_.hand().last().phase, HandPhase::driving) << words();
    go(at_ + Vector3d(0, 0, 0.01), 50);
    stay(100);
    EXPECT_NEAR((tool() - stood - Vector3d(0, 0, 0.01)).norm(), 0, 1e-3) << lets_go;
    stay(100, false);
    go({0, 0, 0}, 100, false);
  }
}

TEST_F(HandControlTest, AModeThatChangesInMotionDoesNotGoBackEither) {
  engage();
  go({0.25, 0, 0}, 25);
  world_.hand().set_mode(HandMode::joints);
  stay(200);
  const Vector3d stood = tool();
  world_.hand().set_mode(HandMode::tool);
  stay(20);
  go(at_ + Vector3d(0, 0, 0.01), 50);
  stay(100);
  EXPECT_NEAR((tool() - stood - Vector3d(0, 0, 0.01)).norm(), 0, 1e-3);
}

TEST_F(HandControlTest, ARobotThatStopsTakesAnotherPress) {
  engage();
  go({0.05, 0, 0}, 30);
  world_.robot().ask(RobotRequest::emergency_stop);
  stay(100);
  EXPECT_EQ(world_.hand().last().phase, HandPhase::refused);
  EXPECT_EQ(world_.hand().last().reason, HandReason::robot_lost);
  world_.robot().ask(RobotRequest::reset);
  go({0.3, 0, 0}, 100);
  EXPECT_EQ(world_.hand().last().phase, HandPhase::refused);
  stay(60, false);
  const double stood = world_.shaft(1);
  EXPECT_EQ(stay(200).phase, HandPhase::driving) << words();
  EXPECT_EQ(world_.shaft(1), stood);
}

TEST_F(HandControlTest, ALineThatIsCutEndsItAndTheRobotIsAskedWhereItStands) {
  for (const bool up : {true, false}) {
    engage();
    go(at_ + Vector3d(0.04, 0, 0), 40);
    (up ? world_.up_cut : world_.down_cut) = true;
    go(at_ + Vector3d(0.05, 0, 0), 200);
    EXPECT_EQ(world_.hand().last().phase, HandPhase::refused) << (up ? "up" : "down");
    world_.up_cut = world_.down_cut = false;
    stay(600, false);
    const double stood = world_.shaft(3);
    EXPECT_EQ(stay(100).phase, HandPhase::driving) << words();
    EXPECT_EQ(world_.shaft(3), stood);
    stay(60, false);
  }
}

TEST_F(HandControlTest, WhatTheArmCannotFollowIsNotMadeUpForLater) {
  engage();
  go({3, 0, 0}, 200);
  EXPECT_TRUE(world_.hand().last().slipped);
  EXPECT_LE(world_.hand().last().position_error, 0.3 + 1e-9);
  stay(200);
  const Vector3d far = tool();
  go({2.4, 0, 0}, 150);
  stay(200);
  EXPECT_LT((tool() - far).x(), -0.1) << "half a metre back, and not all that went beyond the reach";
}

TEST_F(HandControlTest, OutOfReachItSaysSoAndGoesOn) {
  engage();
  int said = 0;
  for (int i = 0; i < 200; ++i) said += go(at_ + Vector3d(0.01, 0, 0), 1).follow != FollowReason::none;
  EXPECT_GT(said, 100);
  EXPECT_EQ(world_.hand().last().phase, HandPhase::driving) << "a hand that asks for too much is no emergency";
  EXPECT_NE(words(), "");
}

TEST_F(HandControlTest, ScalesAndLocksMayChangeAtAnyTime) {
  engage();
  const Vector3d begin = tool();
  world_.hand().settings().translation_scale = 0.5;
  go({0.1, 0, 0}, 200);
  stay(50);
  EXPECT_NEAR(tool().x() - begin.x(), 0.05, 2e-3);
  const Vector3d there = tool();
  world_.hand().settings().translation_scale = 1;
  world_.hand().settings().lock_translation = {true, false, false};
  stay(50);
  EXPECT_NEAR((tool() - there).norm(), 0, 1e-6) << "no jump at the change";
  go({0.2, 0.04, 0}, 200);
  stay(50);
  EXPECT_NEAR((tool() - there - Vector3d(0, 0.04, 0)).norm(), 0, 2e-3);
  world_.hand().settings().translation_scale = NAN;
  const JointValues before = stay(50).positions;
  EXPECT_EQ(go({0.3, 0, 0}, 50).positions, before);
}

TEST_F(HandControlTest, TheHandTurnsTheToolWithinItsScale) {
  engage();
  const Eigen::Matrix3d before = world_.hand().last().T_base_tip.linear();
  world_.hand().settings().rotation_scale = 0.5;
  TrackerState device = device_at(at_, true);
  for (int i = 0; i <= 400; ++i) {
    device.T_space_hand.linear() = Eigen::AngleAxisd(0.001 * i, Vector3d::UnitZ()).toRotationMatrix();
    world_.cycle(device);
  }
  world_.cycles(50, device);
  const Eigen::AngleAxisd turned(world_.hand().last().T_base_tip.linear() * before.transpose());
  EXPECT_NEAR(turned.angle(), 0.2, 2e-3);
  EXPECT_NEAR(turned.axis().z(), 1, 1e-2);
}

TEST_F(HandControlTest, ForwardIsWhereTheOperatorLooks) {
  world_.hand().settings().frame = HandFrame::view;
  // A camera that looks along the base's y, upright: its x along the base's x, its y down.
  Eigen::Matrix3d R;
  R << 1, 0, 0, 0, 0, 1, 0, -1, 0;
  world_.T_base_view.linear() = R;
  engage();
  const Vector3d before = tool();
  go({0.04, 0, 0}, 100);
  stay(50);
  EXPECT_NEAR((tool() - before - Vector3d(0, 0.04, 0)).norm(), 0, 2e-3);
  const Vector3d there = tool();
  go({0.04, 0.03, 0}, 100);
  stay(50);
  EXPECT_NEAR((tool() - there - Vector3d(-0.03, 0, 0)).norm(), 0, 2e-3) << "left is left in the picture";
  EXPECT_NEAR((world_.hand().in_space({0, 1, 0}) - Vector3d(1, 0, 0)).norm(), 0, 1e-9) << "and felt likewise";
}

TEST_F(HandControlTest, RecentringTurnsForwardToWhereTheHandPoints) {
  TrackerState device = device_at(at_, false);
  device.T_space_hand.linear() = Eigen::AngleAxisd(M_PI / 2, Vector3d::UnitZ()).toRotationMatrix();
  world_.cycles(60, device);
  device.buttons.set(TrackerButton::recentre);
  world_.cycles(3, device);
  device.buttons = device_at(at_, true).buttons;
  world_.cycles(400, device);
  ASSERT_EQ(world_.hand().last().phase, HandPhase::driving) << words();
  const Vector3d before = tool();
  for (int i = 0; i < 100; ++i) {
    device.T_space_hand.translation().y() = 0.0004 * i;
    world_.cycle(device);
  }
  world_.cycles(50, device);
  EXPECT_NEAR((tool() - before - Vector3d(0.0396, 0, 0)).norm(), 0, 2e-3);
}

TEST_F(HandControlTest, OneJointAtATime) {
  engage();
  world_.hand().set_mode(HandMode::joints);
  TrackerState device = device_at(at_, true);
  device.joint = 4;
  device.joint_rate = 1;
  const JointValues before = world_.hand().last().positions;
  world_.cycles(125, device);
  const HandCycle& out = world_.hand().last();
  EXPECT_NEAR(out.positions[4] - before[4], 0.3 * 1.5, 5e-3) << "a second at its jogging speed";
  for (const std::size_t i : {0u, 1u, 2u, 3u, 5u, 6u, 7u, 8u, 9u}) EXPECT_EQ(out.positions[i], before[i]);
  device.joint_rate = -1;
  world_.cycles(3000, device);
  EXPECT_EQ(out.positions[4], world_.joints()[4].limits.min_position);
  device.joint_rate = NAN;
  world_.cycles(5, device);
  EXPECT_EQ(out.positions[4], world_.joints()[4].limits.min_position);
}

TEST_F(HandControlTest, TheGripperOpensAndClosesByButtons) {
  engage();
  TrackerState device = device_at(at_, true);
  device.buttons.set(TrackerButton::gripper_close);
  const JointValues before = world_.hand().last().positions;
  world_.cycles(200, device);
  EXPECT_EQ(world_.hand().last().positions[7], 0);
  for (std::size_t i = 0; i < 7; ++i) EXPECT_EQ(world_.hand().last().positions[i], before[i]) << "the arm holds";
  EXPECT_NEAR(world_.shaft(7), 0, 1e-4);
}

/// Lets all pass, and keeps what the jaws' joint was last asked for.
class WatchfulGuard final : public HandGuard {
 public:
  FollowStep step(const JointValues& from, const Pose&, double) noexcept override { return seen(from); }
  FollowStep go(const JointValues&, const JointValues& to) noexcept override { return seen(to); }
  std::optional<double> jaws;

 private:
  FollowStep seen(const JointValues& positions) noexcept {
    jaws = positions[7];
    FollowStep out;
    out.q = JointVector::Map(positions.data(), 7);
    return out;
  }
};

// What jaws take is told by the guard, also where nothing but the gripper moves.
TEST_F(HandControlTest, TheGuardSeesJawsUnderAHandThatIsStill) {
  WatchfulGuard guard;
  world_.hand().set_guard(&guard);
  engage();
  TrackerState device = device_at(at_, true);
  device.buttons.set(TrackerButton::gripper_close);
  world_.cycles(100, device);
  EXPECT_EQ(guard.jaws, world_.hand().last().positions[7]);
  guard.jaws.reset();
  world_.cycles(5, device_at(at_, true));
  EXPECT_FALSE(guard.jaws) << "a hand that is still asks nothing";
  world_.hand().set_guard(nullptr);
}

TEST_F(HandControlTest, ATriggerDoesNotOpenAGripperThatHolds) {
  TrackerState device = device_at(at_, false);
  device.grip = 0;  // open, and the gripper holds something at a quarter of its way
  world_.cycles(60, device);
  device.buttons = device_at(at_, true).buttons;
  const double held = world_.cycles(400, device).positions[7];
  EXPECT_EQ(held, 0.03);
  device.grip = 0.1;
  EXPECT_EQ(world_.cycles(50, device).positions[7], held) << "not yet by where it stands";
  for (double grip = 0.1; grip < 0.8; grip += 0.01) {
    device.grip = grip;
    world_.cycle(device);
  }
  EXPECT_NEAR(world_.cycles(150, device).positions[7], 0.04 * (1 - *device.grip), 1e-9) << "now it goes along";
  device.grip = 0.2;
  EXPECT_NEAR(world_.cycles(150, device).positions[7], 0.032, 1e-9);
  device.grip = NAN;
  EXPECT_NEAR(world_.cycles(5, device).positions[7], 0.032, 1e-9);
}

TEST_F(HandControlTest, AHeadMovesThePanTiltWithinItsVelocity) {
  engage();
  world_.others[8] = 1.5;
  world_.others[9] = NAN;
  const HandCycle& out = stay(300);
  EXPECT_EQ(out.positions[8], 1.5);
  EXPECT_EQ(out.positions[9], -0.2);
  world_.others[0] = 2;
  EXPECT_EQ(stay(50).positions[0], 0.2) << "the arm is the hand's";
}

TEST_F(HandControlTest, ADeviceMovesTheCameraToo) {
  engage();
  TrackerState device = device_at(at_, true);
  device.pan_rate = 1;
  device.tilt_rate = 0.5;
  const JointValues before = world_.hand().last().positions;
  const HandCycle& out = world_.cycles(125, device);
  EXPECT_NEAR(out.positions[8] - before[8], 0.3 * 2, 5e-3) << "left, a second long";
  EXPECT_NEAR(out.positions[9] - before[9], -0.3, 5e-3) << "and up, at half of the speed";
  device.pan_rate = NAN;
  device.tilt_rate = 0;
  const JointValues there = out.positions;
  EXPECT_EQ(world_.cycles(20, device).positions, there);
}

TEST_F(HandControlTest, ARobotThatDoesNotFollowEndsIt) {
  HandOptions options = hand_options(read_rig(source_folder() / "configs/minerva.yaml"));
  HandControl hand(options, "minerva");
  HandInput input;
  input.robot.joints = options.gate.joints.size();
  input.robot.ready = true;
  const auto run = [&](int cycles, bool held) -> const HandCycle& {
    for (int i = 0; i < cycles; ++i) {
      input.now = input.now + 10ms;
      input.device = device_at({0, 0, 0}, held);
      input.device.time = input.now;
      hand.cycle(input);
    }
    return hand.last();
  };
  run(10, false);
  EXPECT_EQ(run(100, true).phase, HandPhase::driving);
  EXPECT_EQ(run(400, true).reason, HandReason::robot_silent);
  run(1, false);
  input.robot.ready = false;
  EXPECT_EQ(run(5, true).reason, HandReason::robot_not_ready);
  run(1, false);
  input.robot.begin[3] = NAN;
  EXPECT_EQ(run(5, true).reason, HandReason::bad_number);
  EXPECT_EQ(hand.last().joints, 0u) << "nothing to send";
  run(1, false);
  input.robot.joints = 3;
  EXPECT_EQ(run(5, true).reason, HandReason::robot_unknown);
}

TEST_F(HandControlTest, KeysDriveItAsAHandDoes) {
  KeyboardMouse keys;
  const auto cycles = [&](int count) {
    for (int i = 0; i < count; ++i) {
      keys.looked(world_.now());
      world_.cycle(keys.read(world_.now()), true);
    }
  };
  cycles(50);
  keys.key(HandKey::deadman, true);
  cycles(400);
  ASSERT_EQ(world_.hand().last().phase, HandPhase::driving) << words();
  const Vector3d before = tool();
  keys.key(HandKey::up, true);
  cycles(50);
  keys.key(HandKey::up, false);
  cycles(50);
  EXPECT_NEAR((tool() - before - Vector3d(0, 0, 0.06)).norm(), 0, 2e-3);
  keys.focus_lost();
  cycles(2);
  EXPECT_FALSE(world_.hand().last().deadman);
}

TEST_F(HandControlTest, ACycleDoesNotAllocate) {
  HandOptions options = hand_options(read_rig(source_folder() / "configs/minerva.yaml"));
  HandControl hand(options, "minerva");
  HandInput input;
  input.robot.joints = options.gate.joints.size();
  input.robot.begin = {0.2, 0.6, -0.1, 1.2, 0.3, 0.7, -0.2, 0.03};
  input.robot.ready = input.robot.follows = true;
  const std::size_t before = allocations();
  for (int i = 0; i < 400; ++i) {
    input.now = input.now + 10ms;
    input.device = device_at({0.001 * i, 0, 0}, i % 100 > 10);
    input.device.time = input.now;
    hand.cycle(input);
  }
  EXPECT_EQ(allocations(), before);
  EXPECT_EQ(hand.last().phase, HandPhase::driving);
}

TEST_F(HandControlTest, EveryReasonHasWordsAndACure) {
  for (int i = 1; i <= static_cast<int>(HandReason::bad_number); ++i) {
    HandCycle cycle;
    cycle.reason = static_cast<HandReason>(i);
    cycle.fault = HandFault::jumped;
    EXPECT_NE(describe(cycle, {}).name, "") << i;
    EXPECT_NE(describe(cycle, {}).cure, "") << i;
  }
  for (int i = 1; i <= static_cast<int>(HandFault::jumped); ++i)
    EXPECT_NE(words_for(static_cast<HandFault>(i)).cure, "") << i;
  for (int i = 1; i <= static_cast<int>(FollowReason::bad_target); ++i)
    EXPECT_NE(words_for(static_cast<FollowReason>(i), "elbow").name, "") << i;
}

}  // namespace
}  // namespace foresight::hand_control_test

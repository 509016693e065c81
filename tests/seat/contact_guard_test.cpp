// A hand that presses into things: what is sent stays off them, slides, and tells why.
#include "seat/contact_guard.hpp"

#include "seat/hand_sight.hpp"
#include "seat/tool_script.hpp"
#include "session/live_scene.hpp"
#include "tests/input/hand_world.hpp"
#include "tests/support/folders.hpp"

namespace foresight::contact_guard_test {
namespace {

using Eigen::Vector3d;

const Rig& lab_rig() {
  static const Rig rig = read_rig(source_folder() / "configs" / "minerva.yaml");
  return rig;
}

std::shared_ptr<const SceneModel> lab_scene(bool physics = false) {
  return live_scene_of(lab_rig(), true, std::nullopt, physics).model();
}

/// The robot's gate keeps nothing apart: contact alone counts.
Rig without_clearance() {
  Rig out = lab_rig();
  out.surroundings = {};
  return out;
}

/// Judges joints by meshes of its own, apart from the guard's.
class Judge {
 public:
  explicit Judge(const std::shared_ptr<const SceneModel>& scene)
      : scene_(scene), model_(*lab_rig().robot, names(), scene_.get(), lab_rig().T_world_robot, "judge") {}
  /// m from whatever is nearest; 0: touches.
  double clear(const JointValues& positions) {
    EXPECT_EQ(model_.pose(std::span(positions.data(), model_.joints())), nullptr);
    const auto least = model_.least();
    return least ? least->distance : kContactReach;
  }

 private:
  static std::vector<std::string> names() {
    std::vector<std::string> out = lab_rig().joint_names();
    for (std::string& name : out)
      if (name == "pan" || name == "tilt") name.clear();
    return out;
  }
  std::shared_ptr<const SceneModel> scene_;
  ContactModel model_;
};

class PressingHand : public testing::Test {
 protected:
  explicit PressingHand(const Rig& rig = lab_rig())
      : rig_(rig), scene_(lab_scene()), options_(hand_options(rig_)), guard_(rig_, options_, scene_), judge_(scene_) {
    world_.hand().settings().frame = HandFrame::base;
    world_.hand().set_guard(&guard_);
  }
  void TearDown() override {
    EXPECT_EQ(world_.steps_too_long, 0);
    EXPECT_EQ(world_.moved_while_open, 0);
    EXPECT_EQ(world_.jumps_at_press, 0);
    EXPECT_EQ(world_.shafts_moved_at_rest, 0);
    EXPECT_GT(nearest_, kLeastSkin) << "m: of all that was sent";
    EXPECT_GT(nearest_shafts_, 0) << "m: of where the robot was";
  }
  void go(const Vector3d& by, int cycles, bool held = true) {
    const Vector3d from = at_;
    for (int i = 1; i <= cycles; ++i) {
      at_ = from + by * i / cycles;
      const HandCycle& out = world_.cycle(device_at(at_, held));
      if (i % 8 == 0) look(out);
    }
  }
  void look(const HandCycle& out) {
    nearest_ = std::min(nearest_, judge_.clear(out.positions));
    JointValues shafts{};
    for (std::size_t i = 0; i < out.joints; ++i) shafts[i] = world_.shaft(i);
    nearest_shafts_ = std::min(nearest_shafts_, judge_.clear(shafts));
  }
  void engage() {
    go({0, 0, 0}, 60, false);
    go({0, 0, 0}, 300);
    ASSERT_EQ(world_.hand().last().phase, HandPhase::driving);
  }
  Vector3d tool() { return (rig_.T_world_robot * world_.hand().last().T_base_tip).translation(); }

  Rig rig_;
  std::shared_ptr<const SceneModel> scene_;
  HandOptions options_;
  ContactGuard guard_;
  HandWorld world_;
  Judge judge_;
  Vector3d at_{0, 0, 0};
  double nearest_ = 1, nearest_shafts_ = 1;
};

class PressingWithoutClearance : public PressingHand {
 protected:
  PressingWithoutClearance() : PressingHand(without_clearance()) {}
};

TEST_F(PressingHand, InTheOpenTheToolGoesWithTheHand) {
  engage();
  const Vector3d before = tool();
  go({0.04, -0.03, 0.03}, 150);
  go({0, 0, 0}, 60);
  // The rig's base is turned by a quarter.
  EXPECT_LT((tool() - before - lab_rig().T_world_robot.linear() * Vector3d(0.04, -0.03, 0.03)).norm(), 1e-3);
  EXPECT_FALSE(guard_.sight().ghost.shown);
  EXPECT_EQ(world_.hand().last().follow, FollowReason::none);
}

// Down into the table, then along it: what is sent and the robot stay off, the tool slides, the ghost is at the hand.
TEST_F(PressingHand, SlidesAboveTheTableAndTheGhostIsWhereTheHandIs) {
  engage();
  go({0, 0, -0.7}, 350);
  const Vector3d stopped = tool();
  EXPECT_EQ(world_.hand().last().follow, FollowReason::contact);
  EXPECT_TRUE(guard_.sight().known);
  EXPECT_NE(guard_.sight().ghost.words, "");
  go({0.06, -0.05, 0}, 200);
  go({0, 0, 0}, 60);
  const Vector3d slid = lab_rig().T_world_robot.linear().transpose() * (tool() - stopped);
  EXPECT_NEAR(slid.x(), 0.06, 0.02);
  EXPECT_NEAR(slid.y(), -0.05, 0.02);
  EXPECT_NEAR(slid.z(), 0, 0.02);
  const HandCycle& out = world_.hand().last();
  ASSERT_TRUE(out.T_base_target);
  const GhostHand ghost = guard_.sight().ghost;
  EXPECT_TRUE(ghost.shown);
  EXPECT_LT((ghost.T_base_hand.translation() - out.T_base_target->translation()).norm(), 1e-9);
  EXPECT_GT(out.position_error, 0.1);
  EXPECT_LT(out.position_error, 0.31) << "the leash";
  for (std::size_t i = 0; i < 7; ++i)
    EXPECT_NEAR(world_.shaft(i), out.positions[i], 2e-3) << "commanded is where it is";
}

TEST_F(PressingWithoutClearance, MeshesAloneStopItAndAreNamed) {
  engage();
  go({0, 0, -0.7}, 350);
  const TouchSight seen = guard_.sight();
  EXPECT_EQ(seen.ghost.reason, GhostReason::contact);
  EXPECT_THAT(seen.ghost.words, testing::HasSubstr(" touches "));
  ASSERT_FALSE(seen.near.empty());
  EXPECT_NEAR(seen.near[0].distance, kSkin, 4e-4);
  EXPECT_TRUE(std::ranges::any_of(seen.near, [&](const NearPart& near) {
    return near.distance < 2 * kSkin && seen.ghost.words == near.part + " touches " + near.other;
  })) << seen.ghost.words;
  EXPECT_GT(seen.ghost.depth, 0.05);
  HandSight sight;
  sight.phase = HandPhase::driving;
  sight.touch = seen;
  const auto lines = hand_lines(sight, {});
  ASSERT_FALSE(lines.empty());
  EXPECT_EQ(lines[0].words, seen.ghost.words);
  EXPECT_THAT(lines[0].cure, testing::HasSubstr("move away"));
}

TEST_F(PressingWithoutClearance, LetGoOfAndPressedAgainNothingJumps) {
  engage();
  go({0, 0, -0.6}, 300);
  go({0, 0, 0}, 60, false);
  const JointValues open = world_.hand().last().positions;
  go({0.1, 0.1, 0.3}, 40, false);  // the hand goes alone
  go({0, 0, 0}, 150);
  for (std::size_t i = 0; i < 8; ++i) EXPECT_NEAR(world_.hand().last().positions[i], open[i], 1e-9) << i;
  const Vector3d before = tool();
  go({0, 0, 0.1}, 200);  // away at once: nothing of the hand's way into the table is left
  go({0, 0, 0}, 60);
  EXPECT_NEAR(tool().z() - before.z(), 0.1, 5e-3);
  EXPECT_EQ(world_.presses, 2);
}

// Single joints stop there, too.
TEST_F(PressingWithoutClearance, AJointThatIsMovedAloneStopsAtTheTable) {
  world_.hand().set_mode(HandMode::joints);
  TrackerState device = device_at({0, 0, 0}, false);
  for (int i = 0; i < 60; ++i) world_.cycle(device);
  device.buttons.set(TrackerButton::deadman);
  device.joint = 1;  // the shoulder: forward and down
  device.joint_rate = 1;
  double before = 0;
  for (int i = 0; i < 800; ++i) {
    const HandCycle& out = world_.cycle(device);
    if (i % 8 == 0) look(out);
    if (i == 700) before = out.positions[1];
  }
  const HandCycle& out = world_.hand().last();
  EXPECT_LT(out.positions[1], options_.gate.joints[1].limits.max_position - 0.05) << "the table is before its limit";
  EXPECT_EQ(out.positions[1], before);
  EXPECT_EQ(out.follow, FollowReason::contact);
  device.joint_rate = -1;
  for (int i = 0; i < 100; ++i) world_.cycle(device);
  EXPECT_LT(world_.hand().last().positions[1], before - 0.05) << "and come back";
}

TEST_F(PressingHand, WhereTheSceneIsNotKnownNothingMoves) {
  engage();
  std::vector<Pose> nodes = scene_->rest_poses();
  for (Pose& node : nodes) node.translation().x() = std::nan("");
  guard_.scene_stands(nodes);
  const JointValues before = world_.hand().last().positions;
  go({0.05, 0, 0}, 60);
  EXPECT_EQ(world_.hand().last().positions, before);
  EXPECT_EQ(world_.hand().last().follow, FollowReason::unknown);
  EXPECT_FALSE(guard_.sight().known);
  guard_.scene_stands({});
  go({0, 0, 0}, 60);
  EXPECT_TRUE(guard_.sight().known);
  EXPECT_NE(world_.hand().last().positions, before) << "it goes on";
}

/// A closed hand that starts at a place by the brick and is asked to go on; nothing else moves.
class HandByBrick {
 public:
  explicit HandByBrick(bool loose) : guard_(lab_rig(), hand_, live_.model()), kinematics_(*hand_.arm) {
    const std::string names[] = {"brick_red", "no such thing"};
    if (loose) guard_.may_push(names);
    const std::vector<ToolStep> steps = pick_and_place(lab_rig(), live_, "brick_red", "tray");
    const auto close = std::ranges::find_if(steps.begin() + 1, steps.end(),
                                            [](const ToolStep& s) { return s.what == ToolStep::What::gripper; });
    T_base_brick_ = lab_rig().T_world_robot.inverse() * (close - 1)->T_world_tool;
    q_[7] = 0.004;
  }
  /// `by`: from where it would grasp the brick, along the tool's axes.
  void stand(const Vector3d& by) {
    const JointVector arm = kinematics_.solve(at(by)).q;
    for (std::size_t i = 0; i < 7; ++i) q_[hand_.arm_joints[i]] = arm[static_cast<Eigen::Index>(i)];
  }
  /// Where it gets when it is drawn to there, likewise.
  Vector3d go(const Vector3d& to) {
    FollowStep out;
    for (int i = 0; i < 150; ++i) {
      out = guard_.step(q_, at(to), 0.01);
      for (std::size_t k = 0; k < 7; ++k) q_[hand_.arm_joints[k]] = out.q[static_cast<Eigen::Index>(k)];
    }
    return T_base_brick_.inverse() * out.T_base_tip.translation();
  }
  void move_brick(const Vector3d& by) {
    std::vector<Pose> nodes = live_.model()->rest_poses();
    const auto brick = static_cast<std::size_t>(*live_.model()->find("brick_red"));
    nodes[brick].translation() += (lab_rig().T_world_robot * T_base_brick_).linear() * by;
    guard_.scene_stands(nodes);
  }
  const ContactGuard& guard() const { return guard_; }

 private:
  Pose at(const Vector3d& by) const {
    Pose out = T_base_brick_;
    out.translation() += T_base_brick_.linear() * by;
    return out;
  }
  const LiveScene live_ = live_scene_of(lab_rig(), true, std::nullopt, true);
  const HandOptions hand_ = hand_options(lab_rig());
  ContactGuard guard_;
  InverseKinematics kinematics_;
  Pose T_base_brick_;
  JointValues q_{};
};

TEST(ContactGuard, WhatIsLooseIsPushedAsideAsFarAsItGivesWay) {
  const Vector3d beside(-0.07, 0, 0), through(0.05, 0, 0);
  HandByBrick firm(false), loose(true);
  firm.stand(beside);
  loose.stand(beside);
  const double stopped = firm.go(through).x();
  EXPECT_THAT(firm.guard().sight().ghost.words, testing::HasSubstr("touches brick_red"));
  EXPECT_LT(stopped, -0.02);
  const double pushes = loose.go(through).x();
  EXPECT_NEAR(pushes - stopped, kPushDepth, 0.004) << "ahead of what the scene shows";
  EXPECT_THAT(loose.guard().sight().ghost.words, testing::HasSubstr("touches brick_red")) << "it does not give way";
  loose.move_brick({0.03, 0, 0});
  EXPECT_NEAR(loose.go(through).x() - pushes, 0.03, 0.004);
  EXPECT_LT(loose.go(beside).x(), beside.x() + 1e-3) << "and back";
}

TEST(ContactGuard, WhatIsLooseIsNotPressedOntoItsTable) {
  const Vector3d above(0, 0, -0.06), down(0, 0, 0.02);
  HandByBrick firm(false), loose(true);
  firm.stand(above);
  loose.stand(above);
  const double stopped = firm.go(down).z();
  EXPECT_LT(stopped, -0.005);
  EXPECT_NEAR(loose.go(down).z(), stopped, 5e-4);
}

// A brick between jaws that press: it goes along, and stays where it is let go of.
TEST(ContactGuard, WhatTheJawsHoldIsCarried) {
  const LiveScene live = live_scene_of(lab_rig(), true, std::nullopt, true);
  const HandOptions hand = hand_options(lab_rig());
  ContactGuard guard(lab_rig(), hand, live.model());
  const InverseKinematics kinematics(*hand.arm);
  const std::vector<ToolStep> steps = pick_and_place(lab_rig(), live, "brick_red", "tray");
  const auto close = std::ranges::find_if(steps.begin() + 1, steps.end(),
                                          [](const ToolStep& s) { return s.what == ToolStep::What::gripper; });
  const Pose T_base_world = lab_rig().T_world_robot.inverse();
  const Pose at_brick = T_base_world * (close - 1)->T_world_tool;
  JointValues q{};
  const JointVector arm = kinematics.solve(at_brick).q;
  for (std::size_t i = 0; i < 7; ++i) q[hand.arm_joints[i]] = arm[static_cast<Eigen::Index>(i)];
  q[7] = 0.038;
  const auto step = [&](const Pose& to) {
    const FollowStep out = guard.step(q, to, 0.01);
    for (std::size_t i = 0; i < 7; ++i) q[hand.arm_joints[i]] = out.q[static_cast<Eigen::Index>(i)];
    return out;
  };
  step(at_brick);
  EXPECT_EQ(guard.sight().carried, "");
  for (q[7] = 0.038; q[7] > 0.016; q[7] -= 5e-4) step(at_brick);
  ASSERT_EQ(guard.sight().carried, "brick_red");
  Pose up = at_brick;
  up.translation().z() += 0.08;
  for (int i = 0; i < 200; ++i) step(up);
  up.translation().y() += 0.06;  // across: a brick that was left behind would be in the way
  FollowStep out;
  for (int i = 0; i < 200; ++i) out = step(up);
  EXPECT_LT(out.position_error, 1e-3) << guard.sight().ghost.words;
  EXPECT_EQ(guard.sight().carried, "brick_red");
  for (; q[7] < 0.036; q[7] += 5e-4) step(up);
  EXPECT_EQ(guard.sight().carried, "");
  EXPECT_TRUE(guard.sight().known);
}

TEST(HandLines, JointsNearTheirLimitsAreTold) {
  const HandOptions hand = hand_options(lab_rig());
  JointValues q{};
  q[3] = 0.96 * hand.arm->joints()[3].upper;
  q[5] = -hand.arm->joints()[5].upper;
  HandSight sight;
  sight.joints = 10;
  sight.limits = near_limits(hand, q);
  ASSERT_EQ(sight.limits.size(), 2u);
  const auto lines = hand_lines(sight, lab_rig().joint_names());
  ASSERT_EQ(lines.size(), 2u);
  EXPECT_EQ(lines[0].words, "joint 6 (wrist_pitch) at 100 % of its range; joint 4 (elbow) at 96 % of its range");
}

TEST(HandLines, WhatTheHandMovesIsTold) {
  HandSight sight;
  sight.has_tool = true;
  EXPECT_TRUE(hand_lines(sight, {}).empty()) << "nothing is known of the robot";
  sight.joints = 10;
  EXPECT_EQ(hand_lines(sight, {}).back().words, "the tool");
  sight.mode = HandMode::joints;
  sight.joint = 3;
  const SeatLine line = hand_lines(sight, lab_rig().joint_names()).back();
  EXPECT_EQ(line.words, "joint 4 (elbow) alone");
  EXPECT_EQ(line.cure, "M: the tool again");
}

}  // namespace
}  // namespace foresight::contact_guard_test

#include "prediction/path_follower.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "tests/prediction/sample_arms.hpp"
#include "tests/support/allocations.hpp"
#include "tests/support/folders.hpp"
#include "tests/support/palletiser.hpp"

namespace foresight::path_follower_test {
namespace {

constexpr double kCycle = 0.004;

JointVector bent(const ArmChain& arm) {
  JointVector q(static_cast<Eigen::Index>(arm.size()));
  q << 0.3, 0.7, -0.4, 1.2, 0.5, -0.8, 0.2;
  return q;
}

// The largest step of a joint as a share of velocity * dt.
double step_over_limit(const ArmChain& arm, const JointVector& before, const JointVector& after, double dt) {
  double most = 0;
  for (std::size_t i = 0; i < arm.size(); ++i) {
    const auto at = static_cast<Eigen::Index>(i);
    most = std::max(most, std::abs(after[at] - before[at]) / (arm.joints()[i].velocity * dt));
  }
  return most;
}

TEST(PathFollower, AStillTargetMovesNothingBitForBit) {
  const InverseKinematics kinematics(lab_arm());
  PathFollower follower(kinematics, bent(kinematics.chain()));
  const JointVector start = follower.joints();
  const Pose hand = follower.hand();
  for (int i = 0; i < 100; ++i) {
    const FollowStep step = follower.step(hand, kCycle);
    EXPECT_EQ(step.reason, FollowReason::none);
    EXPECT_TRUE(step.q == start);
  }
}

TEST(PathFollower, ASlowHandIsFollowedExactly) {
  const InverseKinematics kinematics(lab_arm());
  PathFollower follower(kinematics, bent(kinematics.chain()));
  const Pose from = follower.hand();
  Pose to = from;
  to.translation() += Eigen::Vector3d(0.08, -0.1, 0.06);
  to.linear() = Eigen::AngleAxisd(0.4, Eigen::Vector3d::UnitY()).toRotationMatrix() * from.linear();
  for (int i = 1; i <= 500; ++i) {
    const FollowStep step = follower.step(pose_between(from, to, i / 500.0), kCycle);
    ASSERT_EQ(step.reason, FollowReason::none) << i;
    EXPECT_LT(step.position_error, 1e-9);
    EXPECT_LT(step.rotation_error, 1e-9);
  }
}

TEST(PathFollower, NoJointStepsFartherThanItMayWhateverTheTarget) {
  std::mt19937_64 random(1);
  for (int a = 0; a < 12; ++a) {
    const InverseKinematics kinematics(a < 3 ? lab_arm() : any_spherical_arm(random));
    const ArmChain& arm = kinematics.chain();
    PathFollower follower(kinematics, any_joints(arm, random));
    for (int leap = 0; leap < 10; ++leap) {
      const Pose target = arm.tip_pose(any_joints(arm, random));
      for (int i = 0; i < 50; ++i) {
        const double dt = any_number(random, 1e-3, 2e-2);
        const JointVector before = follower.joints();
        const FollowStep step = follower.step(target, dt);
        ASSERT_LE(step_over_limit(arm, before, step.q, dt), 1.0);
        ASSERT_TRUE(arm.within_limits(step.q));
        ASSERT_LT(pose_difference(arm.tip_pose(step.q), step.T_base_tip).norm(), 1e-12);
      }
    }
  }
}

TEST(PathFollower, ATargetTooFastIsReachedLaterOnAStraightLine) {
  const InverseKinematics kinematics(lab_arm());
  PathFollower follower(kinematics, bent(kinematics.chain()));
  const Pose from = follower.hand();
  Pose to = from;
  to.translation() += Eigen::Vector3d(-0.1, 0.1, 0.05);
  int cycles = 0;
  for (FollowStep step; cycles == 0 || step.reason != FollowReason::none; ++cycles) {
    ASSERT_LT(cycles, 1000);
    step = follower.step(to, kCycle);
    if (step.reason == FollowReason::none) break;
    EXPECT_EQ(step.reason, FollowReason::joint_speed);
    EXPECT_GE(step.joint, 0);
    EXPECT_TRUE(step.on_line);
    EXPECT_GT(step.progress, 0);
    const Eigen::Vector3d way = (to.translation() - from.translation()).normalized();
    const Eigen::Vector3d off = step.T_base_tip.translation() - from.translation();
    EXPECT_LT((off - way.dot(off) * way).norm(), 1e-7);
  }
  EXPECT_GT(cycles, 10);
}

// Out to where the arm is straight, and beyond, and back: slowly, with the reason, and never for good.
TEST(PathFollower, AtTheEndOfItsReachTheHandSlowsDownAndComesBack) {
  const InverseKinematics kinematics(lab_arm());
  const ArmChain& arm = kinematics.chain();
  JointVector q = JointVector::Zero(7);
  q << 0, 0.6, 0, 0.9, 0, 0.4, 0;
  PathFollower follower(kinematics, q);
  const Pose start = follower.hand();
  const Eigen::Vector3d shoulder(0, 0, 1.09);
  Pose out = start;
  out.translation() += 0.5 * (start.translation() - shoulder).normalized();
  std::set<FollowReason> reasons;
  const auto go = [&](const Pose& from, const Pose& to, int cycles) {
    FollowStep step;
    for (int i = 1; i <= cycles; ++i) {
      const JointVector before = follower.joints();
      step = follower.step(pose_between(from, to, std::min(1.0, 1.25 * i / cycles)), kCycle);
      reasons.insert(step.reason);
      EXPECT_LE(step_over_limit(arm, before, step.q, kCycle), 1.0);
    }
    return step;
  };
  const FollowStep far = go(start, out, 1000);
  EXPECT_TRUE(far.reason == FollowReason::out_of_reach || far.reason == FollowReason::singularity);
  EXPECT_TRUE(reasons.contains(FollowReason::singularity));
  EXPECT_NEAR(far.position_error, kinematics.solve(out).position_error, 5e-3);
  const FollowStep back = go(out, start, 1000);
  EXPECT_EQ(back.reason, FollowReason::none);
  EXPECT_LT(back.position_error, 1e-9);
}

// The arm stretched out to the very end, and a target straight towards the shoulder: no tangent leads there.
TEST(PathFollower, AStretchedArmIsNotStuck) {
  const InverseKinematics kinematics(lab_arm());
  PathFollower follower(kinematics, JointVector::Zero(7));
  Pose target = follower.hand();
  target.translation().z() -= 0.05;
  FollowStep step;
  int standing = 0;
  for (int i = 0; i < 500 && (i == 0 || step.reason != FollowReason::none); ++i) {
    const JointVector before = follower.joints();
    step = follower.step(target, kCycle);
    EXPECT_LE(step_over_limit(kinematics.chain(), before, step.q, kCycle), 1.0);
    standing += step.q == before && step.reason != FollowReason::none;
  }
  EXPECT_EQ(step.reason, FollowReason::none);
  EXPECT_EQ(standing, 0);
}

// The wrist's axes in line halfway: the joints pass through, no branch is jumped to.
TEST(PathFollower, TheHandPassesThroughASingularWrist) {
  const InverseKinematics kinematics(lab_arm());
  const ArmChain& arm = kinematics.chain();
  JointVector from = bent(arm), to = from;
  from[5] = -0.4, to[5] = 0.4;
  PathFollower follower(kinematics, from);
  const Pose start = follower.hand(), end = arm.tip_pose(to);
  FollowStep step;
  int standing = 0;
  for (int i = 1; i <= 1000; ++i) {
    const JointVector before = follower.joints();
    step = follower.step(pose_between(start, end, std::min(1.0, i / 500.0)), kCycle);
    standing += step.q == before && step.reason != FollowReason::none;
  }
  EXPECT_EQ(step.reason, FollowReason::none);
  EXPECT_EQ(standing, 0);
}

ArmChain palletiser(Linkage linkage) {
  const TempFolder folder;
  return read_arm_chain(folder.write("r.urdf", palletiser_urdf(linkage)), "hand");
}

Pose moved(const Pose& from, const Eigen::Vector3d& way, const Eigen::AngleAxisd& turn) {
  Pose to = from;
  to.translation() += way;
  to.linear() = turn.toRotationMatrix() * from.linear();
  return to;
}

TEST(PathFollower, WhatFollowsAJointIsNeverFasterThanItMay) {
  std::mt19937_64 random(3);
  for (const Linkage linkage : {Linkage::forearm_by_rods, Linkage::by_lever, Linkage::in_two_halves}) {
    const InverseKinematics kinematics(palletiser(linkage));
    const ArmChain& arm = kinematics.chain();
    const auto named = [&](const char* name) {
      return std::ranges::find(arm.joints(), name, &ArmJoint::name) - arm.joints().begin();
    };
    const Eigen::Index elbow = named(linkage == Linkage::by_lever ? "rear_lever" : "elbow");
    const bool halves = linkage == Linkage::in_two_halves;
    const double factor = halves ? 0.7 : 1, most = halves ? 0.9 : 0.8;  // of wrist_rods
    double fastest = 0;
    PathFollower follower(kinematics, arm.middle());
    for (int leap = 0; leap < 10; ++leap) {
      const Pose target = arm.tip_pose(any_joints(arm, random));
      for (int i = 0; i < 100; ++i) {
        const JointVector before = follower.joints();
        const FollowStep step = follower.step(target, kCycle);
        fastest = std::max(fastest, factor * std::abs(step.q[elbow] - before[elbow]) / kCycle);
        ASSERT_LE(step_over_limit(arm, before, step.q, kCycle), 1.0);
      }
    }
    EXPECT_LE(fastest, most);
    EXPECT_GT(fastest, 0.99 * most) << "and no slower";
  }
}

TEST(PathFollower, APalletisersHandGoesAndTurnsWithTheOperators) {
  for (const Linkage linkage : {Linkage::forearm_by_rods, Linkage::at_the_wrist, Linkage::by_lever}) {
    const InverseKinematics kinematics(palletiser(linkage));
    PathFollower follower(kinematics, kinematics.chain().middle());
    const Pose from = follower.hand();
    const Pose to = moved(from, {-0.1, 0.15, 0.08}, Eigen::AngleAxisd(0.6, Eigen::Vector3d::UnitZ()));
    for (int i = 1; i <= 500; ++i) {
      const FollowStep step = follower.step(pose_between(from, to, i / 500.0), kCycle);
      ASSERT_EQ(step.reason, FollowReason::none) << i;
      EXPECT_LT(step.position_error, 1e-9);
      EXPECT_LT(step.rotation_error, 1e-6);
    }
    const JointVector there = follower.joints();
    for (int i = 0; i < 10; ++i) EXPECT_TRUE(follower.step(to, kCycle).q == there) << "a still hand";
  }
}

TEST(PathFollower, AHandThatFewJointsCannotTurnIsFollowedInPlaceAndTold) {
  const InverseKinematics kinematics(palletiser(Linkage::forearm_by_rods));
  PathFollower follower(kinematics, kinematics.chain().middle());
  const Pose from = follower.hand();
  const Pose tilted = moved(from, {-0.1, 0.1, 0.1}, Eigen::AngleAxisd(0.5, Eigen::Vector3d::UnitX()));
  FollowStep step;
  for (int i = 1; i <= 300; ++i) {
    step = follower.step(pose_between(from, tilted, std::min(1.0, i / 250.0)), kCycle);
    ASSERT_LT(step.position_error, 1e-9) << i;
  }
  EXPECT_EQ(step.reason, FollowReason::few_joints);
  EXPECT_NEAR(step.rotation_error, 0.5, 0.01) << "all of the tilt is left";
  const JointVector there = follower.joints();
  EXPECT_TRUE(follower.step(tilted, kCycle).q == there);
  const Pose turned = moved(tilted, {0, 0, 0}, Eigen::AngleAxisd(1, Eigen::Vector3d::UnitZ()));
  step = follower.step(turned, kCycle);
  EXPECT_EQ(step.reason, FollowReason::joint_speed) << "what it can turn takes its time";
  EXPECT_EQ(kinematics.chain().joints()[static_cast<std::size_t>(step.joint)].name, "wrist_roll");
  const Pose back = moved(from, {-0.1, 0.1, 0.1}, Eigen::AngleAxisd(0, Eigen::Vector3d::UnitX()));
  for (int i = 1; i <= 100; ++i) step = follower.step(back, kCycle);
  EXPECT_EQ(step.reason, FollowReason::none);
  EXPECT_LT(step.rotation_error, 1e-6);
}

TEST(PathFollower, BadTargetsAndCyclesMoveNothing) {
  const InverseKinematics kinematics(lab_arm());
  PathFollower follower(kinematics, bent(kinematics.chain()));
  const JointVector start = follower.joints();
  Pose there = follower.hand(), nan = there;
  there.translation().x() += 0.1;
  nan.translation().x() = std::nan("");
  EXPECT_EQ(follower.step(nan, kCycle).reason, FollowReason::bad_target);
  EXPECT_EQ(follower.step(there, 0).reason, FollowReason::bad_target);
  EXPECT_EQ(follower.step(there, -1).reason, FollowReason::bad_target);
  EXPECT_EQ(follower.step(there, std::nan("")).reason, FollowReason::bad_target);
  EXPECT_TRUE(follower.joints() == start);
}

TEST(PathFollower, AStepDoesNotAllocate) {
  std::mt19937_64 random(2);
  const InverseKinematics kinematics(lab_arm()), of_few(palletiser(Linkage::forearm_by_rods));
  for (const InverseKinematics* k : {&kinematics, &of_few}) {
    const ArmChain& arm = k->chain();
    PathFollower follower(*k, arm.middle());
    for (int leap = 0; leap < 20; ++leap) {
      Pose target = arm.tip_pose(any_joints(arm, random));
      if (leap % 4 == 0) target.translation() *= 2;
      const std::size_t before = allocations();
      for (int i = 0; i < 50; ++i) follower.step(target, 0.02);
      EXPECT_EQ(allocations() - before, 0u);
    }
  }
}

}  // namespace
}  // namespace foresight::path_follower_test

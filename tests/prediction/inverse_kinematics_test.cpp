#include "prediction/inverse_kinematics.hpp"

#include <limits>
#include <numbers>

#include "tests/prediction/sample_arms.hpp"
#include "tests/scene/test_run.hpp"
#include "tests/support/allocations.hpp"
#include "tests/support/palletiser.hpp"

namespace foresight::inverse_kinematics_test {
namespace {

constexpr double kPi = std::numbers::pi;

// Six joints without a spherical wrist, of usual proportions.
ArmChain offset_wrist_arm() {
  const auto joint = [](const char* name, Eigen::Vector3d axis, Eigen::Vector3d point) {
    return ArmJoint{name, false, axis, point, -kPi, kPi, 2, true};
  };
  const Eigen::Vector3d x(1, 0, 0), y(0, 1, 0), z(0, 0, 1);
  return ArmChain({joint("1", z, {0, 0, 0}), joint("2", y, {0, 0.1, 0.1}), joint("3", y, {0.4, 0, 0.1}),
                   joint("4", y, {0.8, 0.1, 0.1}), joint("5", -z, {0.8, 0.12, 0}), joint("6", y, {0.8, 0.12, 0.0})},
                  Pose(Eigen::Translation3d(0.8, 0.2, 0.0)), "arm");
}

ArmChain short_arm(std::size_t joints) {
  const ArmChain lab = lab_arm();
  return ArmChain({lab.joints().begin(), lab.joints().begin() + static_cast<std::ptrdiff_t>(joints)}, lab.tip_at_zero(),
                  "short arm");
}

TEST(InverseKinematics, ArmsOfNoClosedFormAreSolvedStepByStep) {
  const InverseKinematics kinematics(offset_wrist_arm());
  EXPECT_FALSE(kinematics.closed_form());
  std::mt19937_64 random(1);
  int solved = 0;
  for (int i = 0; i < 1000; ++i) {
    const Pose target = kinematics.chain().tip_pose(any_joints(kinematics.chain(), random));
    const IkAnswer a = kinematics.solve(target);
    EXPECT_TRUE(kinematics.chain().within_limits(a.q));
    solved += a.status == IkStatus::solved && pose_difference(kinematics.chain().tip_pose(a.q), target).norm() < 2e-9;
  }
  EXPECT_GE(solved, 998);
}

TEST(InverseKinematics, APandaIsSolved) {
  const char* file = "robots/panda/diff_robot_data/panda_description/urdf/panda_no_gripper.urdf";
  FORESIGHT_NEED_DATA(file);
  const InverseKinematics kinematics(read_arm_chain(data_folder() / file, "panda_virtual_ee_link"));
  std::mt19937_64 random(2);
  int solved = 0;
  for (int i = 0; i < 4000; ++i) {
    const Pose target = kinematics.chain().tip_pose(any_joints(kinematics.chain(), random));
    solved += kinematics.solve(target).status == IkStatus::solved;
  }
  EXPECT_GE(solved, 3998);
}

TEST(InverseKinematics, AnIiwaIsSolvedInClosedForm) {
  const char* file = "robots/iiwa7/diff_robot_data/kuka_iiwa/urdf/iiwa7.urdf";
  FORESIGHT_NEED_DATA(file);
  const InverseKinematics kinematics(read_arm_chain(data_folder() / file, "iiwa_link_ee"));
  EXPECT_TRUE(kinematics.closed_form());
  std::mt19937_64 random(3);
  for (int i = 0; i < 4000; ++i) {
    const Pose target = kinematics.chain().tip_pose(any_joints(kinematics.chain(), random));
    ASSERT_EQ(kinematics.solve(target).status, IkStatus::solved) << i;
  }
}

TEST(InverseKinematics, OutOfReachTheNearestPoseIsFoundAndSaidToBeThat) {
  const InverseKinematics kinematics(lab_arm());
  const ArmChain& arm = kinematics.chain();
  const Eigen::Vector3d shoulder(0, 0, 1.09);
  std::mt19937_64 random(4);
  for (int i = 0; i < 50; ++i) {
    // Straight on from a hand that points outwards: 0.75 m is all there is.
    Pose target = Pose::Identity();
    Eigen::Vector3d out = any_direction(random);
    out.z() = std::abs(out.z());
    target.linear() = Eigen::Quaterniond::FromTwoVectors(Eigen::Vector3d::UnitZ(), out).toRotationMatrix();
    target.translation() = shoulder + any_number(random, 0.8, 1.5) * out;
    const IkAnswer a = kinematics.solve(target);
    EXPECT_EQ(a.status, IkStatus::nearest);
    EXPECT_TRUE(arm.within_limits(a.q));
    EXPECT_LT(pose_difference(a.T_base_tip, arm.tip_pose(a.q)).norm(), 1e-12);
    const double beyond = (target.translation() - shoulder).norm() - 0.75;
    EXPECT_NEAR(a.position_error, beyond, 1e-3) << out.transpose();
    EXPECT_LT(a.rotation_error, 0.02);
  }
}

TEST(InverseKinematics, NothingNearIsNearerThanTheNearest) {
  for (const ArmChain& arm : {lab_arm(), offset_wrist_arm()}) {
    const InverseKinematics kinematics(arm);
    std::mt19937_64 random(5);
    for (int i = 0; i < 20; ++i) {
      Pose target = arm.tip_pose(any_joints(arm, random));
      target.translation() *= 2;
      const IkAnswer a = kinematics.solve(target);
      if (a.status == IkStatus::solved) continue;
      const DescentGoal goal{target, false, kinematics.length()};
      const double error = weighted_error(a.T_base_tip, goal).norm();
      for (int k = 0; k < 200; ++k) {
        JointVector q = a.q;
        for (Eigen::Index j = 0; j < q.size(); ++j)
          q[j] = std::clamp(q[j] + any_number(random, -0.01, 0.01), arm.lower()[j], arm.upper()[j]);
        EXPECT_GE(weighted_error(arm.tip_pose(q), goal).norm(), error - 1e-6);
      }
    }
  }
}

TEST(InverseKinematics, FewerThanSixJointsReachThePositionFirst) {
  std::mt19937_64 random(6);
  for (const std::size_t joints : {3, 4, 5}) {
    const InverseKinematics kinematics(short_arm(joints));
    EXPECT_TRUE(kinematics.position_first());
    EXPECT_NE(kinematics.description().find("the position first"), std::string::npos);
    int solved = 0;
    for (int i = 0; i < 100; ++i) {
      Pose target = kinematics.chain().tip_pose(any_joints(kinematics.chain(), random));
      target.linear() = Eigen::AngleAxisd(1, any_direction(random)).toRotationMatrix();
      const IkAnswer a = kinematics.solve(target);
      solved += a.status == IkStatus::solved;
      if (a.status == IkStatus::solved) {
        EXPECT_LT((a.T_base_tip.translation() - target.translation()).norm(), 1e-9);
      }
    }
    EXPECT_GE(solved, 98) << joints;
  }
}

TEST(InverseKinematics, FewerThanSixJointsTurnTheTipAsNearlyAsTheyCan) {
  std::mt19937_64 random(8);
  for (const std::size_t joints : {4, 5}) {
    const InverseKinematics kinematics(short_arm(joints));
    const ArmChain& arm = kinematics.chain();
    int exact = 0;
    for (int i = 0; i < 100; ++i) {
      const Pose target = arm.tip_pose(any_joints(arm, random));
      const IkAnswer a = kinematics.solve(target);
      exact += a.status == IkStatus::solved && a.rotation_error < 1e-8;
    }
    EXPECT_GE(exact, 95) << joints << " joints, of poses that can be reached";
    for (int i = 0; i < 50; ++i) {
      const JointVector near = any_joints(arm, random);
      Pose target = arm.tip_pose(near);
      target.linear() = Eigen::AngleAxisd(0.4, any_direction(random)).toRotationMatrix() * target.linear();
      const IkAnswer a = kinematics.solve(target, near);
      ASSERT_EQ(a.status, IkStatus::solved);
      EXPECT_LT(a.rotation_error, 0.4 + 1e-9) << "no farther than where it is";
      EXPECT_LT(kinematics.solve(target, a.q).largest_change, 0.01) << "and there it stays";
    }
  }
}

// What the four drives of a palletiser can do: go anywhere, with the hand level, and turn it about the vertical.
TEST(InverseKinematics, APalletisersHandIsTurnedAboutTheVertical) {
  const TempFolder folder;
  std::mt19937_64 random(9);
  for (const Linkage linkage :
       {Linkage::forearm_by_rods, Linkage::at_the_wrist, Linkage::by_lever, Linkage::in_two_halves}) {
    const InverseKinematics kinematics(read_arm_chain(folder.write("r.urdf", palletiser_urdf(linkage)), "hand"));
    EXPECT_FALSE(kinematics.closed_form());
    int exact = 0;
    for (int i = 0; i < 100; ++i) {
      const Pose target = kinematics.chain().tip_pose(any_joints(kinematics.chain(), random));
      const IkAnswer a = kinematics.solve(target);
      exact += a.status == IkStatus::solved && a.rotation_error < 1e-8;
    }
    EXPECT_GE(exact, 98);
  }
}

// A follower that turns back what the first wrist joint does: no spherical wrist, though seven joints have the lines.
TEST(InverseKinematics, AnArmWithFollowersIsNotSolvedInClosedForm) {
  const ArmChain lab = lab_arm();
  const std::vector<ArmJoint> joints(lab.joints().begin(), lab.joints().end());
  const ArmChain arm(joints, lab.tip_at_zero(), "arm", {{4, 6, -0.5, false, joints[5].axis, joints[5].point}});
  const InverseKinematics kinematics(arm);
  EXPECT_TRUE(InverseKinematics(lab).closed_form());
  EXPECT_FALSE(kinematics.closed_form());
  std::mt19937_64 random(10);
  for (int i = 0; i < 30; ++i)
    EXPECT_EQ(kinematics.solve(arm.tip_pose(any_joints(arm, random))).status, IkStatus::solved);
}

TEST(InverseKinematics, TargetsThatAreNoPosesAreRefused) {
  const InverseKinematics kinematics(lab_arm());
  JointVector last = kinematics.chain().middle();
  last[2] = 0.5;
  Pose nan = Pose::Identity(), flat = Pose::Identity(), mirror = Pose::Identity();
  nan.translation().x() = std::numeric_limits<double>::quiet_NaN();
  flat.linear().setZero();
  mirror.linear()(0, 0) = -1;
  for (const Pose& target : {nan, flat, mirror}) {
    EXPECT_EQ(kinematics.solve(target).status, IkStatus::bad_target);
    const IkAnswer a = kinematics.solve(target, last);
    EXPECT_EQ(a.status, IkStatus::bad_target);
    EXPECT_TRUE(a.q == last);
  }
}

TEST(InverseKinematics, SolvingDoesNotAllocate) {
  for (const ArmChain& arm : {lab_arm(), offset_wrist_arm(), short_arm(4)}) {
    const InverseKinematics kinematics(arm);
    std::mt19937_64 random(7);
    for (int i = 0; i < 20; ++i) {
      const JointVector q = any_joints(arm, random);
      Pose target = arm.tip_pose(q);
      if (i % 5 == 0) target.translation() *= 3;  // out of reach
      const std::size_t before = allocations();
      const bool any = kinematics.solve(target).status == IkStatus::bad_target ||
                       kinematics.solve(target, q).status == IkStatus::bad_target;
      EXPECT_EQ(allocations() - before, 0u);
      EXPECT_FALSE(any);
    }
  }
}

}  // namespace
}  // namespace foresight::inverse_kinematics_test

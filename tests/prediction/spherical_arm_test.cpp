#include "prediction/spherical_arm.hpp"

#include <gtest/gtest.h>

#include "prediction/inverse_kinematics.hpp"
#include "tests/prediction/sample_arms.hpp"

namespace foresight::spherical_arm_test {
namespace {

// What the answer must be: the pose, within limits.
testing::AssertionResult is_exact(const ArmChain& arm, const IkAnswer& answer, const Pose& target) {
  const Vector6 miss = pose_difference(arm.tip_pose(answer.q), target);
  if (answer.status == IkStatus::solved && arm.within_limits(answer.q, 1e-12) && miss.head<3>().norm() < 1e-9 &&
      miss.tail<3>().norm() < 1e-9)
    return testing::AssertionSuccess();
  return testing::AssertionFailure() << "status " << static_cast<int>(answer.status) << ", missed by "
                                     << miss.transpose() << ", joints " << answer.q.transpose();
}

TEST(SphericalArm, IsRecognisedByWhereItsAxesLie) {
  std::mt19937_64 random(1);
  EXPECT_TRUE(SphericalArm::recognise(lab_arm()));
  EXPECT_TRUE(SphericalArm::recognise(mirrored(lab_arm())));
  for (int i = 0; i < 50; ++i) EXPECT_TRUE(SphericalArm::recognise(any_spherical_arm(random))) << i;

  const ArmChain arm = lab_arm();
  std::vector<ArmJoint> joints(arm.joints().begin(), arm.joints().end());
  const auto recognised = [&] { return SphericalArm::recognise(ArmChain(joints, arm.tip_at_zero(), "a")).has_value(); };
  joints[5].point.x() += 0.001;  // a wrist that misses by 1 mm
  EXPECT_FALSE(recognised());
  joints.assign(arm.joints().begin(), arm.joints().end());
  joints[1].axis = Eigen::Vector3d(0, 1, 0.01).normalized();  // a shoulder that is not square
  EXPECT_FALSE(recognised());
  joints.assign(arm.joints().begin(), arm.joints().end());
  joints[3].axis = Eigen::Vector3d::UnitZ();  // turns in place
  EXPECT_FALSE(recognised());
  joints.assign(arm.joints().begin(), arm.joints().end());
  joints.pop_back();
  EXPECT_FALSE(recognised());
}

TEST(SphericalArm, AnyPoseOfAnyArmIsSolvedWithinItsLimits) {
  std::mt19937_64 random(2);
  for (int a = 0; a < 100; ++a) {
    ArmChain arm = any_spherical_arm(random);
    if (a % 2) arm = mirrored(arm);
    const InverseKinematics kinematics(arm);
    ASSERT_TRUE(kinematics.closed_form());
    for (int i = 0; i < 50; ++i) {
      const Pose target = arm.tip_pose(any_joints(arm, random));
      EXPECT_TRUE(is_exact(arm, kinematics.solve(target), target)) << "arm " << a << ", pose " << i;
      EXPECT_TRUE(kinematics.solve(target).q == kinematics.solve(target).q);
    }
  }
}

// A range of joints may be as narrow as one angle: the interval of the swivel is then one too.
TEST(SphericalArm, JointsOnTheirLimitsAreSolved) {
  std::mt19937_64 random(3);
  for (int a = 0; a < 60; ++a) {
    const ArmChain arm = a < 10 ? lab_arm() : any_spherical_arm(random);
    const InverseKinematics kinematics(arm);
    for (int i = 0; i < 70; ++i) {
      JointVector q = any_joints(arm, random);
      const int one = i % 7, other = (i / 7) % 7;  // every pair, and each alone
      for (const int j : {one, other}) {
        const double limit = random() % 2 ? arm.lower()[j] : arm.upper()[j];
        if (std::isfinite(limit)) q[j] = limit;
      }
      const Pose target = arm.tip_pose(q);
      EXPECT_TRUE(is_exact(arm, kinematics.solve(target), target))
          << "arm " << a << ", joints " << one << " and " << other << ": " << q.transpose();
    }
  }
}

TEST(SphericalArm, NarrowLimitsLeaveNarrowIntervalsAndTheyAreFound) {
  std::mt19937_64 random(4);
  for (int i = 0; i < 300; ++i) {
    ArmChain wide = any_spherical_arm(random);
    std::vector<ArmJoint> joints(wide.joints().begin(), wide.joints().end());
    const JointVector q = any_joints(wide, random);
    const double width = std::pow(10.0, any_number(random, -9, -1));
    for (std::size_t j = 0; j < 7; ++j) {
      joints[j].lower = q[static_cast<Eigen::Index>(j)] - any_number(random, 0.1, 1) * width;
      joints[j].upper = q[static_cast<Eigen::Index>(j)] + any_number(random, 0.1, 1) * width;
    }
    const ArmChain arm(joints, wide.tip_at_zero(), "narrow arm");
    const Pose target = arm.tip_pose(q);
    EXPECT_TRUE(is_exact(arm, InverseKinematics(arm).solve(target), target)) << "width " << width;
  }
}

// Singular shoulders, wrists and elbows: where angles of a branch are not determined, or fall together.
TEST(SphericalArm, SingularPosesAreSolved) {
  const ArmChain arm = lab_arm();
  const InverseKinematics kinematics(arm);
  std::mt19937_64 random(5);
  for (int i = 0; i < 400; ++i) {
    JointVector q = any_joints(arm, random);
    for (const int j : {1, 3, 5})
      if (i >> (j / 2) & 1) q[j] = i % 3 == 0 ? 0 : any_number(random, -1e-9, 1e-9);
    const Pose target = arm.tip_pose(q);
    EXPECT_TRUE(is_exact(arm, kinematics.solve(target), target)) << i << ": " << q.transpose();
  }
}

TEST(SphericalArm, RightAnglesOfFewDigitsAreMadeUpFor) {
  std::mt19937_64 random(6);
  for (int a = 0; a < 40; ++a) {
    const ArmChain right = any_spherical_arm(random);
    std::vector<ArmJoint> joints(right.joints().begin(), right.joints().end());
    const double off = a % 2 ? 4e-6 : 2e-4;  // "1.5708", "1.571"
    for (ArmJoint& joint : joints) joint.axis = (joint.axis + off * any_direction(random)).normalized();
    const ArmChain arm(joints, right.tip_at_zero(), "arm of few digits");
    const InverseKinematics kinematics(arm);
    ASSERT_TRUE(kinematics.closed_form());
    for (int i = 0; i < 50; ++i) {
      JointVector q = any_joints(arm, random);
      const Pose anywhere = arm.tip_pose(q);
      EXPECT_TRUE(is_exact(arm, kinematics.solve(anywhere), anywhere)) << "arm " << a << ", pose " << i;
      const int j = i % 7;
      if (std::isfinite(arm.upper()[j])) q[j] = i % 2 ? arm.lower()[j] : arm.upper()[j];
      const Pose at_limit = arm.tip_pose(q);
      EXPECT_TRUE(is_exact(arm, kinematics.solve(at_limit), at_limit)) << "arm " << a << ", joint " << j << " of " << i;
    }
  }
}

double margin_of(const ArmChain& arm, const SphericalArm& spherical, const JointVector& q) {
  double margin = spherical.elbow_bend(q[3]);
  for (const int j : {1, 5}) margin = std::min(margin, std::abs(std::sin(q[j])));  // of the lab's arm: 0 in line
  return std::min({margin, (q - arm.lower()).minCoeff(), (arm.upper() - q).minCoeff()});
}

TEST(SphericalArm, TheElbowGoesWhereTheMarginIsLargest) {
  const ArmChain arm = lab_arm();
  const auto spherical = SphericalArm::recognise(arm);
  std::mt19937_64 random(7);
  double found = 0, best_of_many = 0;
  for (int i = 0; i < 200; ++i) {
    const JointVector q = any_joints(arm, random);
    const auto answer = spherical->solve(arm.tip_pose(q));
    ASSERT_TRUE(answer);
    const double margin = margin_of(arm, *spherical, answer->q);
    EXPECT_NEAR(answer->margin, margin, 2e-4);
    // Every branch from every swivel angle, by starting anywhere.
    double best = margin_of(arm, *spherical, q);
    for (int k = 0; k < 200; ++k)
      if (const auto other = spherical->solve_near(arm.tip_pose(q), any_joints(arm, random), 0))
        best = std::max(best, margin_of(arm, *spherical, other->q));
    EXPECT_GT(margin, 0.7 * best - 0.02) << q.transpose();
    found += margin, best_of_many += best;
  }
  EXPECT_GT(found, 0.98 * best_of_many);
}

TEST(SphericalArm, NearTheLastJointsIsTheirOwnBranch) {
  std::mt19937_64 random(8);
  for (int a = 0; a < 40; ++a) {
    const ArmChain arm = any_spherical_arm(random);
    const InverseKinematics kinematics(arm);
    for (int i = 0; i < 25; ++i) {
      const JointVector q = any_joints(arm, random);
      const IkAnswer same = kinematics.solve(arm.tip_pose(q), q, 0);
      EXPECT_TRUE(is_exact(arm, same, arm.tip_pose(q)));
      EXPECT_LT(same.largest_change, 1e-5) << q.transpose();  // an elbow that is almost straight: the root of rounding
      JointVector moved = q;
      for (Eigen::Index j = 0; j < 7; ++j)
        moved[j] = std::clamp(q[j] + any_number(random, -1e-4, 1e-4), arm.lower()[j], arm.upper()[j]);
      const Pose target = arm.tip_pose(moved);
      const IkAnswer next = kinematics.solve(target, q, 0);
      EXPECT_TRUE(is_exact(arm, next, target));
      EXPECT_LT(next.largest_change, 0.2) << q.transpose();
    }
  }
}

}  // namespace
}  // namespace foresight::spherical_arm_test

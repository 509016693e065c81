#include "prediction/contact/bounded_step.hpp"

#include <gtest/gtest.h>

namespace foresight::bounded_step_test {
namespace {

// Three sliding joints: the tool's position is the joints.
TipChange straight() {
  TipChange change;
  for (Eigen::Index i = 0; i < 3; ++i) change[static_cast<std::size_t>(i)] = Vector6::Unit(i);
  return change;
}

JointVector joints(double x, double y, double z) {
  JointVector q(3);
  q << x, y, z;
  return q;
}

TEST(BoundedStep, WithoutClosedWaysIsTheLeastSquaresStep) {
  Vector6 e = Vector6::Zero();
  e.head<3>() << 0.1, -0.2, 0.3;
  const JointVector x = bounded_step(straight(), e, 1e-9, joints(-1, -1, -1), joints(1, 1, 1), {});
  EXPECT_LT((x - e.head<3>()).norm(), 1e-8);
}

TEST(BoundedStep, TakesAwayOnlyWhatGoesIntoTheSurface) {
  Vector6 e = Vector6::Zero();
  e.head<3>() << 0.1, -0.2, -0.3;
  ClosedWay floor{joints(0, 0, 1), -0.05};
  const JointVector x = bounded_step(straight(), e, 1e-9, joints(-1, -1, -1), joints(1, 1, 1), {&floor, 1});
  EXPECT_LT((x - joints(0.1, -0.2, -0.05)).norm(), 1e-7);
  EXPECT_GT(floor.pressed, 0.1);
}

TEST(BoundedStep, InACornerOnlyTheOpenWayIsLeft) {
  Vector6 e = Vector6::Zero();
  e.head<3>() << 0.3, 0.3, 0.3;
  std::array<ClosedWay, 2> walls{ClosedWay{joints(-1, 0, 0), 0}, ClosedWay{joints(-0.6, -0.8, 0), 0}};
  const JointVector x = bounded_step(straight(), e, 1e-9, joints(-0.1, -0.1, -0.1), joints(0.1, 0.1, 0.1), walls);
  EXPECT_NEAR(x[0], 0, 1e-6);
  EXPECT_NEAR(x[1], 0, 1e-6);
  EXPECT_NEAR(x[2], 0.1, 1e-9);  // as far as the joint goes
}

TEST(BoundedStep, LimitsHoldWhereClosedWaysContradictThem) {
  ClosedWay push{joints(1, 0, 0), 5};
  const JointVector x =
      bounded_step(straight(), Vector6::Zero(), 1e-4, joints(-0.1, -0.1, -0.1), joints(0.1, 0.1, 0.1), {&push, 1});
  EXPECT_LE(x.cwiseAbs().maxCoeff(), 0.1);
}

}  // namespace
}  // namespace foresight::bounded_step_test

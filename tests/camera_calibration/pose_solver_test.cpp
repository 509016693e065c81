#include "calibration/camera/pose_solver.hpp"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <random>
#include <vector>

namespace foresight::pose_solver_test {
namespace {

/// Points of the body, and where they were measured: the residuals are linear in neither turn nor shift.
struct Points {
  std::vector<Eigen::Vector3d> p_body, p_world;
  double sigma = 1;

  Points(const Pose& T_world_body, double noise, unsigned seed) : sigma(noise > 0 ? noise : 1) {
    std::mt19937 random(seed);
    std::normal_distribution<double> normal;
    for (int i = 0; i < 12; ++i) {
      const Eigen::Vector3d p(normal(random), normal(random), normal(random));
      p_body.push_back(p);
      p_world.push_back(T_world_body * p + noise * Eigen::Vector3d(normal(random), normal(random), normal(random)));
    }
  }

  void add(const Pose& T, bool derivatives, PoseEquations<0>& sum) const {
    for (std::size_t i = 0; i < p_body.size(); ++i) {
      const Eigen::Vector3d r = (T * p_body[i] - p_world[i]) / sigma;
      sum.cost += r.squaredNorm() / 2;
      if (!derivatives) continue;
      Eigen::Matrix<double, 3, 6> J;
      for (int axis = 0; axis < 3; ++axis)
        J.col(axis) = T.linear() * Eigen::Vector3d::Unit(axis).cross(p_body[i]) / sigma;
      J.rightCols<3>() = T.linear() / sigma;
      sum.H += J.transpose() * J;
      sum.g += J.transpose() * r;
    }
  }
};

Pose far_pose() {
  return to_motion((Vector6d() << 0.9, -1.2, 0.7, 3, -2, 1).finished());
}

PoseProblem<0> problem_of(const Points& points) {
  return [&](const PoseEstimate<0>& at, bool derivatives, PoseEquations<0>& sum) {
    points.add(at.T, derivatives, sum);
    return true;
  };
}

TEST(PoseSolver, FindsAPoseFarFromItsStart) {
  const Points points(far_pose(), 0, 1);
  const auto found = solve_pose<0>({}, problem_of(points), {});
  ASSERT_TRUE(found.usable);
  EXPECT_TRUE(found.at.T.isApprox(far_pose(), 1e-9)) << found.at.T.matrix();
}

TEST(PoseSolver, TheMinimumDoesNotDependOnTheBase) {
  const Points points(far_pose(), 0.1, 2);
  const auto one = solve_pose<0>({}, problem_of(points), {});
  PoseSolverOptions<0> options;
  options.base = far_pose() * to_motion((Vector6d() << -0.3, 0.5, 0.2, 0.1, 0.2, -0.4).finished());
  const auto other = solve_pose<0>({options.base, {}}, problem_of(points), options);
  EXPECT_TRUE(one.at.T.isApprox(other.at.T, 1e-8));
  PoseEquations<0> there;
  points.add(one.at.T, true, there);
  EXPECT_LT(there.g.norm(), 1e-5 * std::sqrt(there.H.trace()));
}

TEST(PoseSolver, ThePriorIsMetAtItsOwnMinimum) {
  // The gradient of the whole cost, by differences, vanishes at the solution: the prior's slope in the chart is right.
  const Points points(far_pose(), 0.3, 3);
  PoseSolverOptions<0> options;
  options.base = far_pose() * to_motion((Vector6d() << 0.4, -0.5, 0.3, 0.5, -0.2, 0.3).finished());
  options.prior = (Vector6d() << 90, 50, 70, 200, 90, 120).finished().asDiagonal();
  const auto found = solve_pose<0>({options.base, {}}, problem_of(points), options);
  const auto cost = [&](const Vector6d& step) {
    const Pose T = found.at.T * to_motion(step);
    const Vector6d x = to_twist(options.base.inverse() * T);
    PoseEquations<0> sum;
    points.add(T, false, sum);
    return sum.cost + 0.5 * x.dot(options.prior * x);
  };
  for (int axis = 0; axis < 6; ++axis) {
    const Vector6d d = 1e-5 * Vector6d::Unit(axis);
    EXPECT_NEAR((cost(d) - cost(-d)) / 2e-5, 0, 1e-3) << axis;
  }
  EXPECT_GT(to_twist(options.base.inverse() * found.at.T).norm(), 0.1);  // the prior did not hold it
}

TEST(PoseSolver, ErrorsAreAsLargeAsTheEquationsSay) {
  double chi2 = 0;
  constexpr int kRuns = 100;
  for (unsigned run = 0; run < kRuns; ++run) {
    const Points points(far_pose(), 0.05, run);
    const auto found = solve_pose<0>({}, problem_of(points), {});
    const Vector6d error = to_twist(found.at.T.inverse() * far_pose());
    chi2 += error.dot(found.equations.H * error);
  }
  EXPECT_NEAR(chi2 / kRuns, 6, 1);  // 0.35 is its standard deviation
}

TEST(PoseSolver, TakesNoStepToWhereNothingCanBeSaid) {
  // Behind z = 1 the problem is silent, and the minimum lies there.
  const Points points(to_motion((Vector6d() << 0, 0, 0, 0, 0, 0.5).finished()), 0, 4);
  const auto problem = [&](const PoseEstimate<0>& at, bool derivatives, PoseEquations<0>& sum) {
    if (at.T.translation().z() < 1) return false;
    points.add(at.T, derivatives, sum);
    return true;
  };
  const Pose start = to_motion((Vector6d() << 0.1, 0, 0, 0, 0, 2).finished());
  const auto found = solve_pose<0>({start, {}}, problem, {});
  ASSERT_TRUE(found.usable);
  EXPECT_GE(found.at.T.translation().z(), 1);
  EXPECT_LT(found.at.T.translation().z(), 2);
  EXPECT_FALSE(solve_pose<0>({}, problem, {}).usable);
}

TEST(PoseSolver, StaysWhereDerivativesCease) {
  // The cost is known everywhere, its slopes only at the start.
  const Points points(far_pose(), 0, 8);
  int with_derivatives = 0;
  const auto problem = [&](const PoseEstimate<0>& at, bool derivatives, PoseEquations<0>& sum) {
    points.add(at.T, derivatives, sum);
    return !derivatives || ++with_derivatives == 1;
  };
  const Pose near = far_pose() * to_motion(Vector6d::Constant(0.05));
  const auto found = solve_pose<0>({near, {}}, problem, {});
  ASSERT_TRUE(found.usable);
  EXPECT_EQ(with_derivatives, 2);
  const auto off = [](const Pose& T) { return to_twist(far_pose().inverse() * T).norm(); };
  EXPECT_LT(off(found.at.T), off(near) / 5);
}

TEST(PoseSolver, ASmallStepEndsIt) {
  const Points points(far_pose(), 1e-3, 5);
  int with_derivatives = 0;
  const auto problem = [&](const PoseEstimate<0>& at, bool derivatives, PoseEquations<0>& sum) {
    with_derivatives += derivatives;
    points.add(at.T, derivatives, sum);
    return true;
  };
  PoseSolverOptions<0> options;
  options.step_metric = Matrix6d::Identity() / 1e-4;  // 0.01 rad and m
  const Pose near = far_pose() * to_motion(Vector6d::Constant(1e-3));
  const auto found = solve_pose<0>({near, {}}, problem, options);
  EXPECT_EQ(with_derivatives, 1);
  EXPECT_FALSE(found.at.T.isApprox(near, 1e-6));  // the step itself is taken
}

TEST(PoseSolver, EstimatesNumbersBesideThePose) {
  // World = 1.3 body + offset along z, beside the pose.
  const Points points(far_pose(), 0, 6);
  const auto problem = [&](const PoseEstimate<2>& at, bool derivatives, PoseEquations<2>& sum) {
    for (std::size_t i = 0; i < points.p_body.size(); ++i) {
      const Eigen::Vector3d measured = 1.3 * points.p_world[i] + 0.2 * Eigen::Vector3d::UnitZ();
      const Eigen::Vector3d at_world = at.T * points.p_body[i];
      const Eigen::Vector3d r = at.extra[0] * at_world + at.extra[1] * Eigen::Vector3d::UnitZ() - measured;
      sum.cost += r.squaredNorm() / 2;
      if (!derivatives) continue;
      Eigen::Matrix<double, 3, 8> J;
      for (int axis = 0; axis < 3; ++axis)
        J.col(axis) = at.extra[0] * (at.T.linear() * Eigen::Vector3d::Unit(axis).cross(points.p_body[i]));
      J.middleCols<3>(3) = at.extra[0] * at.T.linear();
      J.col(6) = at_world;
      J.col(7) = Eigen::Vector3d::UnitZ();
      sum.H += J.transpose() * J;
      sum.g += J.transpose() * r;
    }
    // Shift and offset along z are one: the offset is held near 0.2.
    const double offset = at.extra[1] - 0.2;
    sum.cost += 0.5 * offset * offset;
    sum.H(7, 7) += 1, sum.g[7] += offset;
    return true;
  };
  PoseSolverOptions<2> options;
  options.most_iterations = 50;
  const auto found = solve_pose<2>({Pose::Identity(), {1, 0}}, problem, options);
  ASSERT_TRUE(found.usable);
  EXPECT_NEAR(found.at.extra[0], 1.3, 1e-6);
  EXPECT_NEAR(found.at.extra[1], 0.2, 1e-5);
  EXPECT_TRUE(found.at.T.isApprox(far_pose(), 1e-5));
}

}  // namespace
}  // namespace foresight::pose_solver_test

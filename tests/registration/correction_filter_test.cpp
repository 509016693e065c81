#include "calibration/registration/correction_filter.hpp"

#include <gtest/gtest.h>

#include <random>

namespace foresight::correction_filter_test {
namespace {

// 500 px of focal length and a scene at 1 m: a metre or a radian are about 500 px.
const Matrix6d kMetric = 250000 * Matrix6d::Identity() / 6;

double px(const Pose& a, const Pose& b) {
  const Vector6d twist = to_twist(a.inverse() * b);
  return std::sqrt(twist.dot(kMetric * twist));
}

Pose still(double) {
  return Pose(Eigen::Translation3d(1, 2, 3));
}

Pose swaying(double t) {
  Vector6d twist;
  twist << 0.1 * std::sin(t), 0.05 * std::cos(1.3 * t), 0, 0.2 * std::sin(0.8 * t), 0.1 * std::cos(t), 0.1 * t;
  return to_motion(twist);
}

struct Errors {
  double given = 0, predicted = 0, sigma = 0;
};

/// Root mean squares over the second half of 120 images, `lag` images arriving late.
template <typename Truth, typename Wrong>
Errors follow(Truth truth, Wrong wrong, int lag) {
  CorrectionFilter filter{CorrectionFilterOptions{}};
  Errors sum;
  constexpr int kImages = 120;
  const auto time = [](int i) { return RobotTime{} + seconds(i / 30.0); };
  for (int i = 0; i < kImages; ++i) {
    const Pose T = truth(i / 30.0), given = T * wrong(i);
    filter.add_given(time(i), given);
    if (i >= lag) filter.add_refined(time(i - lag), truth((i - lag) / 30.0), kMetric);
    const auto predicted = filter.predict(time(i));
    if (i < kImages / 2) continue;
    sum.given += std::pow(px(T, given), 2) / (kImages / 2);
    sum.predicted += std::pow(px(T, predicted.T_world_camera), 2) / (kImages / 2);
    sum.sigma += std::pow(predicted.sigma_px, 2) / (kImages / 2);
  }
  return {std::sqrt(sum.given), std::sqrt(sum.predicted), std::sqrt(sum.sigma)};
}

Pose white(int i) {
  std::mt19937 random(static_cast<unsigned>(i));
  std::normal_distribution<double> normal(0, 2 / 500.0);
  Vector6d twist;
  for (double& x : twist) x = normal(random);
  return to_motion(twist);
}

Pose constant(int) {
  return to_motion((Vector6d() << 0.005, -0.003, 0.001, 0.002, 0.002, -0.004).finished());
}

TEST(CorrectionFilter, GivesTheGivenPoseBeforeAnythingIsKnown) {
  CorrectionFilter filter{CorrectionFilterOptions{}};
  filter.add_given(RobotTime{}, still(0));
  const auto predicted = filter.predict(RobotTime{});
  EXPECT_TRUE(predicted.T_world_camera.isApprox(still(0)));
  EXPECT_EQ(predicted.sigma_px, CorrectionFilterOptions{}.given_px);
}

TEST(CorrectionFilter, LearnsThatACorrectionPersists) {
  const Errors errors = follow(swaying, constant, 3);
  EXPECT_GT(errors.given, 1);
  EXPECT_LT(errors.predicted, 0.15 * errors.given);  // 5 % are the gauge's
}

TEST(CorrectionFilter, LearnsThatErrorsJumpButMotionIsSmooth) {
  const Errors errors = follow(swaying, white, 3);
  EXPECT_GT(errors.given, 1.5);
  EXPECT_LT(errors.predicted, 0.4 * errors.given);
}

TEST(CorrectionFilter, DoesNotSpoilExactPoses) {
  const auto exact = [](int) { return Pose::Identity(); };
  EXPECT_LT(follow(swaying, exact, 3).predicted, 0.02);
}

TEST(CorrectionFilter, TakesTheNoiseOfAlignmentsForNoCorrection) {
  CorrectionFilter filter{CorrectionFilterOptions{}};
  double worst_used = 0, worst_predicted = 0;
  for (int i = 0; i < 120; ++i) {
    const RobotTime time = RobotTime{} + seconds(i / 30.0);
    const Pose exact = swaying(i / 30.0);
    filter.add_given(time, exact);
    const double predicted = px(exact, filter.predict(time).T_world_camera);
    const Pose aligned = exact * to_motion(0.05 * to_twist(white(i)));  // 0.1 px
    const double used = px(exact, filter.add_refined(time, aligned, kMetric));
    if (i < 60) continue;
    worst_used = std::max(worst_used, used);
    worst_predicted = std::max(worst_predicted, predicted);
  }
  EXPECT_LT(worst_used, 0.02);
  EXPECT_LT(worst_predicted, 0.02);
}

TEST(CorrectionFilter, BridgesOneImageOfASmoothMotion) {
  const Errors errors = follow(swaying, white, 1);
  EXPECT_LT(errors.predicted, 0.1 * errors.given);
}

TEST(CorrectionFilter, GivesTheRefinedPoseOfAnImageThatHasArrived) {
  CorrectionFilter filter{CorrectionFilterOptions{}};
  filter.add_given(RobotTime{}, still(0) * white(1));
  const Pose used = filter.add_refined(RobotTime{}, still(0), kMetric);
  EXPECT_TRUE(filter.predict(RobotTime{}).T_world_camera.isApprox(used, 1e-12));
}

TEST(CorrectionFilter, TrustsAgainOnlyWhatIsClearlySmoother) {
  CorrectionFilter filter{CorrectionFilterOptions{}};
  const auto play = [&](int first, int last, double given_error, double found_error) {
    for (int i = first; i < last; ++i) {
      const RobotTime time = RobotTime{} + seconds(i / 30.0);
      const auto wrong = [](int seed, double share) { return to_motion(share * to_twist(white(seed))); };
      filter.add_given(time, swaying(i / 30.0) * wrong(i, given_error));
      filter.add_refined(time, swaying(i / 30.0) * wrong(1000 + i, found_error), kMetric);
    }
  };
  play(0, 20, 0, 1);
  EXPECT_FALSE(filter.helps());
  play(20, 220, 1, 0.9);  // a little smoother
  EXPECT_FALSE(filter.helps());
  play(220, 420, 1, 0.1);
  EXPECT_TRUE(filter.helps());
}

TEST(CorrectionFilter, KnowsItsError) {
  for (const int lag : {1, 3, 6}) {
    const Errors errors = follow(swaying, white, lag);
    EXPECT_GT(errors.sigma, 0.5 * errors.predicted) << lag;
    EXPECT_LT(errors.sigma, 2 * errors.predicted + 0.05) << lag;
  }
}

TEST(CorrectionFilter, GaugeReturnsToTheGivenPoses) {
  CorrectionFilter filter{CorrectionFilterOptions{}};
  // Images agree with a first one that stood 4 px beside; its successors were given right.
  Pose T = still(0) * to_motion((Vector6d() << 0.02, 0, 0, 0, 0, 0).finished());
  const double before = px(T, still(0));
  for (int i = 0; i < 60; ++i) {
    const RobotTime time = RobotTime{} + seconds(i / 30.0);
    filter.add_given(time, still(0));
    T = filter.add_refined(time, T, kMetric);
  }
  EXPECT_LT(px(T, still(0)), 0.1 * before);
}

TEST(CorrectionFilter, DoubtsRefinedPosesThatAreRougherThanTheGivenOnes) {
  CorrectionFilter filter{CorrectionFilterOptions{}};
  for (int i = 0; i < 20; ++i) {
    const RobotTime time = RobotTime{} + seconds(i / 30.0);
    const Pose given = swaying(i / 30.0);
    filter.add_given(time, given);
    const Pose used = filter.add_refined(time, given * white(i), kMetric);
    if (i < 5) continue;
    EXPECT_FALSE(filter.helps());
    EXPECT_TRUE(used.isApprox(given, 1e-12));
  }
}

TEST(CorrectionFilter, RefusesDisorder) {
  CorrectionFilter filter{CorrectionFilterOptions{}};
  filter.add_given(RobotTime{} + seconds(1), still(0));
  EXPECT_THROW(filter.add_given(RobotTime{} + seconds(1), still(0)), std::invalid_argument);
  EXPECT_THROW(filter.predict(RobotTime{} + seconds(2)), std::invalid_argument);
}

}  // namespace
}  // namespace foresight::correction_filter_test

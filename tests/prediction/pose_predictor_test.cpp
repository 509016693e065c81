#include "prediction/pose_predictor.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <random>

#include "common/statistics.hpp"
#include "prediction/arm_chain.hpp"
#include "tests/support/allocations.hpp"

namespace foresight::pose_predictor_test {
namespace {

constexpr double kStep = 1.0 / 60, kAhead = 0.1;

OperatorTime at(double s) {
  return OperatorTime{1'000'000'000'000} + seconds(s);
}

Pose pose(const Eigen::Vector3d& position, const Eigen::Vector3d& turn = Eigen::Vector3d::Zero()) {
  Pose T = Pose::Identity();
  const double angle = turn.norm();
  if (angle > 0) T.linear() = Eigen::AngleAxisd(angle, turn / angle).toRotationMatrix();
  T.translation() = position;
  return T;
}

// Sways and looks about as people do: a few slow sines, and the tracked point 10 cm before the neck's axis.
Pose swaying(double t) {
  const Eigen::Vector3d turn(0.3 * std::sin(2.1 * t), 0.8 * std::sin(1.3 * t + 1), 0.1 * std::sin(3.3 * t));
  const Eigen::Vector3d neck(0.3 * std::sin(0.9 * t) + 0.05 * std::sin(4 * t), 0.03 * std::sin(5 * t + 2),
                             0.2 * std::sin(1.7 * t));
  Pose T = pose(neck, turn);
  T.translation() += T.linear() * Eigen::Vector3d(0, 0, -0.1);
  return T;
}

TEST(PosePredictor, EvenMotionGoesOnExactly) {
  PosePredictor predictor;
  const auto truth = [](double t) { return pose({0.5 * t, -0.2 * t, 1}, {0, 0.8 * t, 0}); };
  for (int i = 0; i < 300; ++i) {
    predictor.observe(at(i * kStep), truth(i * kStep));
    if (i < 1) continue;
    for (const double ahead : {0.0, 0.03, 0.1, 0.2}) {
      const double then = i * kStep + ahead;
      const PosePrediction predicted = predictor.at(at(then));
      const Vector6 off = pose_difference(predicted.pose, truth(then));
      EXPECT_LT(off.norm(), 1e-6) << i << " " << ahead;
      EXPECT_EQ(predicted.status, ahead == 0 ? StateStatus::exact : StateStatus::predicted);
    }
  }
}

TEST(PosePredictor, BeatsConstantVelocityAndKnowsHowSureItIs) {
  std::mt19937 random(3);
  std::normal_distribution<double> noise(0, 0.0003);
  PosePredictor predictor;
  std::vector<double> ours, constant;
  int inside = 0, turns_inside = 0;
  LastOf<Eigen::Vector3d> last(4);
  for (int i = 0; i < 3600; ++i) {
    const double t = i * kStep;
    Pose seen = swaying(t);
    seen.translation() += Eigen::Vector3d(noise(random), noise(random), noise(random));
    predictor.observe(at(t), seen);
    last.next() = seen.translation();
    if (i < 60) continue;
    const PosePrediction predicted = predictor.at(at(t + kAhead));
    const Vector6 off = pose_difference(predicted.pose, swaying(t + kAhead));
    ours.push_back(off.head<3>().norm());
    const Eigen::Vector3d velocity = (last[3] - last[0]) / (3 * kStep);
    constant.push_back((last[3] + velocity * kAhead - swaying(t + kAhead).translation()).norm());
    inside += off.head<3>().norm() <= 2 * predicted.position_sigma;
    turns_inside += off.tail<3>().norm() <= 2 * predicted.rotation_sigma;
  }
  EXPECT_LT(quantile(ours, 0.95), 0.6 * quantile(constant, 0.95));
  const auto count = static_cast<double>(ours.size());
  EXPECT_NEAR(inside / count, 0.94, 0.04);
  EXPECT_NEAR(turns_inside / count, 0.94, 0.04);
}

// The poses are those of a steady clock; the stamps are not.
TEST(PosePredictor, JitterOfTheStampsIsNoMotion) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> jitter(-0.003, 0.003);
  std::vector<double> ours, newest_two;
  PosePredictor predictor;
  OperatorTime last_time;
  for (int i = 0; i < 1800; ++i) {
    const double t = i * kStep, stamp = t + jitter(random);
    const Eigen::Vector3d before = swaying(t - kStep).translation(), now = swaying(t).translation();
    const Eigen::Vector3d truth = swaying(t + kAhead).translation();
    predictor.observe(at(stamp), swaying(t));
    if (i >= 60) {
      ours.push_back((predictor.at(at(stamp) + seconds(kAhead)).pose.translation() - truth).norm());
      newest_two.push_back((now + (now - before) * kAhead / to_seconds(at(stamp) - last_time) - truth).norm());
    }
    last_time = at(stamp);
  }
  EXPECT_LT(quantile(ours, 0.95), 0.4 * quantile(newest_two, 0.95));
}

TEST(PosePredictor, KnowsNothingOfTheFuture) {
  PosePredictor all, half;
  std::vector<Pose> predicted;
  for (int i = 0; i < 400; ++i) {
    all.observe(at(i * kStep), swaying(i * kStep));
    predicted.push_back(all.at(at(i * kStep + kAhead)).pose);
  }
  for (int i = 0; i < 200; ++i) {
    half.observe(at(i * kStep), swaying(i * kStep));
    EXPECT_EQ(half.at(at(i * kStep + kAhead)).pose.matrix(), predicted[static_cast<std::size_t>(i)].matrix());
  }
}

TEST(PosePredictor, WhatTrackersDoWrongIsToldAndSurvived) {
  PosePredictor predictor;
  EXPECT_EQ(predictor.at(at(0)).status, StateStatus::invalid);
  for (int i = 0; i < 60; ++i) predictor.observe(at(i * kStep), swaying(i * kStep));
  const Pose before = predictor.at(at(60 * kStep)).pose;

  Pose wrong = swaying(1);
  wrong.translation().x() = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(predictor.observe(at(60 * kStep), wrong), PoseTaken::invalid);
  wrong = swaying(1);
  wrong.linear() *= 1.1;
  EXPECT_EQ(predictor.observe(at(60 * kStep), wrong), PoseTaken::invalid);
  EXPECT_EQ(predictor.observe(at(59 * kStep), swaying(1)), PoseTaken::late);
  EXPECT_EQ(predictor.at(at(60 * kStep)).pose.matrix(), before.matrix());

  EXPECT_EQ(predictor.at(at(59 * kStep - 0.01)).status, StateStatus::invalid);
  EXPECT_EQ(predictor.at(at(59 * kStep + 0.51)).status, StateStatus::invalid);

  const double sure = predictor.at(at(59 * kStep + kAhead)).position_sigma;
  const Pose far = pose({3, 0, 0});
  EXPECT_EQ(predictor.observe(at(60 * kStep), far), PoseTaken::anew);
  EXPECT_EQ(predictor.at(at(60 * kStep + kAhead)).pose.matrix(), far.matrix());
  EXPECT_GT(predictor.at(at(60 * kStep + kAhead)).position_sigma, 2 * sure);
  EXPECT_EQ(predictor.observe(at(61 * kStep), far), PoseTaken::yes);
  EXPECT_EQ(predictor.observe(at(100 * kStep), far), PoseTaken::anew);
}

TEST(PosePredictor, NeverGoesFarBeyondWhatItSaw) {
  std::mt19937 random(9);
  std::uniform_real_distribution<double> any(-0.02, 0.02);
  PosePredictor predictor;
  for (int i = 0; i < 2000; ++i) {  // steps of pure noise, at uneven times
    const Pose shaken = pose({any(random), any(random), any(random)}, {any(random), any(random), any(random)});
    predictor.observe(at(i * kStep + 0.2 * any(random)), shaken);
    const Pose predicted = predictor.at(at(i * kStep + kAhead)).pose;
    ASSERT_TRUE(predicted.matrix().allFinite());
    EXPECT_LT((predicted.translation() - shaken.translation()).norm(), 1.5 * 0.07 * kAhead / kStep * 2);
  }
}

TEST(PosePredictor, AllocatesNothing) {
  PosePredictor predictor;
  const std::size_t before = allocations();
  for (int i = 0; i < 500; ++i) {
    predictor.observe(at(i * 0.001), swaying(i * 0.001));
    predictor.at(at(i * 0.001 + kAhead));
  }
  EXPECT_EQ(allocations(), before);
}

}  // namespace
}  // namespace foresight::pose_predictor_test

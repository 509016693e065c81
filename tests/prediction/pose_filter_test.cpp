#include "prediction/pose_filter.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

#include "tests/support/allocations.hpp"

namespace foresight::pose_filter_test {
namespace {

constexpr double kStep = 1.0 / 90;

OperatorTime at(double s) {
  return OperatorTime{5'000'000'000} + seconds(s);
}

Pose pose(const Eigen::Vector3d& position, const Eigen::Vector3d& turn) {
  Pose T = Pose::Identity();
  const double angle = turn.norm();
  if (angle > 0) T.linear() = Eigen::AngleAxisd(angle, turn / angle).toRotationMatrix();
  T.translation() = position;
  return T;
}

Pose waving(double t) {
  return pose({0.15 * std::sin(3 * t), 0.1 * std::sin(5 * t + 1), 1 + 0.05 * std::sin(7 * t)},
              {0.4 * std::sin(2 * t), 0, 0.6 * std::sin(4 * t + 2)});
}

struct Errors {
  double noise = 0, seen_noise = 0, along = 0, speed = 0, turn = 0, seen_turn = 0;

  double lag() const { return -along / speed; }
};

// A minute of waving, seen with so much noise (m, and rad times 10).
Errors filtered(double noise) {
  std::mt19937 random(2);
  std::normal_distribution<double> any(0, noise);
  const auto shake = [&] { return Eigen::Vector3d(any(random), any(random), any(random)); };
  PoseFilter filter;
  Errors e;
  for (int i = 0; i < 5400; ++i) {
    const double t = i * kStep;
    Pose seen = waving(t);
    seen.translation() += shake();
    seen.linear() = (pose({0, 0, 0}, 10 * shake()).linear() * seen.linear()).eval();
    filter.observe(at(t), seen);
    if (i < 450) continue;
    const Vector6 off = pose_difference(waving(t), filter.pose()), seen_off = pose_difference(waving(t), seen);
    const Eigen::Vector3d velocity = (waving(t + 1e-4).translation() - waving(t - 1e-4).translation()) / 2e-4;
    e.noise += off.head<3>().squaredNorm();
    e.seen_noise += seen_off.head<3>().squaredNorm();
    e.turn += off.tail<3>().squaredNorm();
    e.seen_turn += seen_off.tail<3>().squaredNorm();
    e.along += off.head<3>().dot(velocity);
    e.speed += velocity.squaredNorm();
  }
  return e;
}

TEST(PoseFilter, TakesNoiseWithoutTakingTime) {
  const Errors much = filtered(0.002), little = filtered(0.0001);
  EXPECT_LT(much.noise, 0.6 * much.seen_noise);
  EXPECT_LT(much.turn, 0.6 * much.seen_turn);
  EXPECT_LT(little.noise, 1.05 * little.seen_noise);
  EXPECT_NEAR(much.lag(), 0, 0.002);
  EXPECT_NEAR(little.lag(), 0, 0.0002);
}

TEST(PoseFilter, EvenMotionPassesAsItIs) {
  PoseFilter filter;
  std::mt19937 random(3);
  std::normal_distribution<double> any(0, 0.002);
  for (int i = 0; i < 900; ++i) {  // learns to smooth
    const Pose seen = pose({any(random), any(random), any(random)}, {0, 0, 0});
    filter.observe(at(i * kStep), seen);
  }
  for (int i = 900; i < 930; ++i) {
    const double t = (i - 900) * kStep;
    const Pose seen = pose({0.5 * t, 0, -0.3 * t}, {0, 2 * t, 0});
    filter.observe(at(i * kStep), seen);
    if (i > 915) {
      EXPECT_LT(pose_difference(seen, filter.pose()).norm(), 1e-9) << i;
    }
  }
}

TEST(PoseFilter, LossesAndJumpsBeginAnew) {
  PoseFilter filter;
  for (int i = 0; i < 200; ++i) filter.observe(at(i * kStep), waving(i * kStep));
  const Pose before = filter.pose();
  Pose lost = waving(2);
  lost.translation().y() = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(filter.observe(at(200 * kStep), lost), PoseTaken::invalid);
  EXPECT_EQ(filter.observe(at(199 * kStep), waving(2)), PoseTaken::late);
  EXPECT_EQ(filter.pose().matrix(), before.matrix());
  const Pose far = pose({5, 0, 0}, {0, 0, 0});
  EXPECT_EQ(filter.observe(at(201 * kStep), far), PoseTaken::anew);
  EXPECT_EQ(filter.pose().matrix(), far.matrix());
}

TEST(PoseFilter, AllocatesNothing) {
  PoseFilter filter;
  const std::size_t before = allocations();
  for (int i = 0; i < 1000; ++i) filter.observe(at(i * 0.001), waving(i * 0.001));
  EXPECT_EQ(allocations(), before);
}

}  // namespace
}  // namespace foresight::pose_filter_test

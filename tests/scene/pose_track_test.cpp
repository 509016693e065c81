#include "scene/pose_track.hpp"

#include <gtest/gtest.h>

#include <stdexcept>

namespace foresight::pose_track_test {
namespace {

constexpr std::int64_t kMs = 1'000'000;
constexpr std::int64_t kUnix = 1'700'000'000'000'000'000;

Pose at_x(double x, double angle_deg = 0) {
  Pose pose = Pose::Identity();
  pose.translation().x() = x;
  pose.linear() = Eigen::AngleAxisd(angle_deg * M_PI / 180, Eigen::Vector3d::UnitZ()).toRotationMatrix();
  return pose;
}

RobotTime ms(double t) {
  return {kUnix + std::llround(t * kMs)};
}

TEST(PoseTrack, UsesANearSampleAsItIs) {
  const PoseTrack track({{ms(0), at_x(0)}, {ms(100), at_x(1)}});
  for (double t : {-1.0, 0.0, 1.0}) {
    EXPECT_EQ(track.at(ms(t)).status, StateStatus::exact) << t;
    EXPECT_EQ(track.at(ms(t)).pose.translation().x(), 0) << t;
  }
  EXPECT_EQ(track.at(ms(99)).pose.translation().x(), 1);
  EXPECT_EQ(track.at(ms(101)).status, StateStatus::exact);
  EXPECT_EQ(track.at(ms(1.000001)).status, StateStatus::interpolated);
}

TEST(PoseTrack, InterpolatesPositionsLinearly) {
  const PoseTrack track({{ms(0), at_x(0)}, {ms(100), at_x(1)}, {ms(300), at_x(5)}});
  EXPECT_NEAR(track.at(ms(30)).pose.translation().x(), 0.3, 1e-12);
  EXPECT_EQ(track.at(ms(30)).status, StateStatus::interpolated);
  EXPECT_NEAR(track.at(ms(70)).pose.translation().x(), 0.7, 1e-12);
  EXPECT_NEAR(track.at(ms(250)).pose.translation().x(), 4, 1e-12);  // a gap of exactly 0.2 s
}

TEST(PoseTrack, InterpolatesRotationsTheShortWay) {
  const PoseTrack track({{ms(0), at_x(0, 170)}, {ms(100), at_x(0, -170)}});
  const auto middle = track.at(ms(50));
  EXPECT_TRUE(middle.pose.linear().isApprox(at_x(0, 180).linear(), 1e-12)) << middle.pose.linear();
  const auto quarter = track.at(ms(25));
  EXPECT_TRUE(quarter.pose.linear().isApprox(at_x(0, 175).linear(), 1e-12));
  EXPECT_NEAR((quarter.pose.linear() * quarter.pose.linear().transpose() - Eigen::Matrix3d::Identity()).norm(), 0,
              1e-12);
}

TEST(PoseTrack, SaysInvalidOutsideAndInLargeGaps) {
  const PoseTrack track({{ms(0), at_x(0)}, {ms(201), at_x(1)}});
  EXPECT_EQ(track.at(ms(100)).status, StateStatus::invalid);
  EXPECT_EQ(track.at(ms(-1.1)).status, StateStatus::invalid);
  EXPECT_EQ(track.at(ms(202.1)).status, StateStatus::invalid);
  EXPECT_EQ(PoseTrack().at(ms(0)).status, StateStatus::invalid);
  EXPECT_EQ(PoseTrack({{ms(0), at_x(0)}}).at(ms(2)).status, StateStatus::invalid);
  EXPECT_EQ(PoseTrack({{ms(0), at_x(0)}}).at(ms(-2)).status, StateStatus::invalid);
}

TEST(PoseTrack, FindsTheNearestSample) {
  const PoseTrack track({{ms(0), at_x(0)}, {ms(100), at_x(1)}, {ms(200), at_x(2)}});
  EXPECT_EQ(track.nearest(ms(-1000)).time, ms(0));
  EXPECT_EQ(track.nearest(ms(149)).time, ms(100));
  EXPECT_EQ(track.nearest(ms(151)).time, ms(200));
  EXPECT_EQ(track.nearest(ms(1000)).time, ms(200));
}

TEST(PoseTrack, RefusesSamplesThatDoNotAscend) {
  EXPECT_THROW(PoseTrack({{ms(0), at_x(0)}, {ms(0), at_x(1)}}), std::invalid_argument);
  EXPECT_THROW(PoseTrack({{ms(1), at_x(0)}, {ms(0), at_x(1)}}), std::invalid_argument);
}

}  // namespace
}  // namespace foresight::pose_track_test

#include "calibration/registration/head_kinematics.hpp"

#include <gtest/gtest.h>

#include "lab_head.hpp"

namespace foresight::head_kinematics_test {
namespace {

RobotTime at(double s) {
  return RobotTime{} + seconds(s);
}

TEST(HeadKinematics, IsTheMockLabsHead) {
  const HeadModel head = lab_head();
  for (const auto& [pan, tilt] : {std::pair{0.0, 0.0}, {0.4, 0.6}, {-0.7, 0.2}, {0.1, -0.3}})
    EXPECT_TRUE(T_world_camera(head, {pan, tilt}).isApprox(sim::T_world_head_left({pan, tilt}), 1e-12));
}

TEST(EncoderTrack, InterpolatesAtTheCalibratedOffset) {
  HeadModel head = lab_head();
  head.offset_s = -0.02;
  EncoderTrack track(head, {});
  for (int i = 0; i < 10; ++i) ASSERT_TRUE(track.add(at(0.01 * i), {0.1 * i, -0.2 * i}));
  const auto answer = track.at(at(0.075));
  EXPECT_EQ(answer.status, StateStatus::interpolated);
  EXPECT_NEAR(answer.shafts.pan, 0.55, 1e-9);
  EXPECT_NEAR(answer.shafts.tilt, -1.1, 1e-9);
  EXPECT_NEAR(answer.rate.pan, 10, 1e-6);
  EXPECT_EQ(track.at(at(0.07)).status, StateStatus::exact);
}

TEST(EncoderTrack, RefusesWhatItCannotKnow) {
  EncoderTrack track(lab_head(), {});
  EXPECT_EQ(track.at(at(0)).status, StateStatus::invalid);
  track.add(at(0), {});
  track.add(at(0.01), {});
  track.add(at(0.5), {1, 1});
  EXPECT_EQ(track.at(at(0.2)).status, StateStatus::invalid) << "in a gap";
  EXPECT_EQ(track.at(at(-0.01)).status, StateStatus::invalid) << "before the first";
  track.add(at(0.51), {1, 1});
  EXPECT_EQ(track.at(at(0.52)).status, StateStatus::predicted);
  EXPECT_EQ(track.at(at(0.55)).status, StateStatus::invalid) << "too far ahead";
  EXPECT_FALSE(track.add(at(0.4), {})) << "not newer";
  EXPECT_FALSE(track.add(at(0.6), {std::nan(""), 0}));
}

TEST(EncoderTrack, ShaftsFollowWithPlay) {
  HeadModel head = lab_head();
  head.pan = {1.01, 0.2, 0.02};
  EncoderTrack track(head, {});
  double shaft = 0;
  const double way[] = {0, 0.1, 0.2, 0.195, 0.185, 0.17, 0.1};
  const double play[] = {0, 0.09, 0.19, 0.19, 0.19, 0.18, 0.11};
  for (int i = 0; i < 7; ++i) {
    track.add(at(0.01 * i), {way[i], 0});
    shaft = track.at(at(0.01 * i)).shafts.pan;
    if (i > 0) {
      EXPECT_NEAR(shaft, 1.01 * play[i] + 0.2, 1e-12) << i;
    }
  }
}

}  // namespace
}  // namespace foresight::head_kinematics_test

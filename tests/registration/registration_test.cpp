#include "calibration/registration/registration.hpp"

#include <gtest/gtest.h>

#include <random>

#include "lab_head.hpp"
#include "sim/tag_room.hpp"

namespace foresight::registration_test {
namespace {

RobotTime at(double s) {
  return RobotTime{} + seconds(s);
}

/// Root mean square over the image at the scene's distance.
double error_px(const Lens& lens, const Pose& truth, const Pose& found) {
  double square = 0;
  int count = 0;
  for (int v = 40; v < lens.height(); v += 80)
    for (int u = 40; u < lens.width(); u += 80) {
      const Eigen::Vector3d p = *lens.unproject({u, v}) * 1.0;
      const auto pixel = lens.project(found.inverse() * truth * p);
      square += (*pixel - Eigen::Vector2d(u, v)).squaredNorm();
      ++count;
    }
  return std::sqrt(square / count);
}

/// The head sweeps; the encoders are read at 100 Hz, 10 ms late, with noise. The truth differs from
/// the model by a hidden offset.
struct Lab {
  explicit Lab(const HeadAngles& hidden_offset) : hidden(hidden_offset) { head.offset_s = 0.01; }

  HeadAngles shafts(double t) const { return {0.35 * std::sin(0.9 * t), 0.5 + 0.12 * std::sin(1.3 * t + 1)}; }
  Pose T_world_left(double t) const {
    return sim::T_world_head_left({shafts(t).pan + hidden.pan, shafts(t).tilt + hidden.tilt});
  }
  void feed(Registration& registration, double until) {
    std::normal_distribution<double> noise(0, 1e-4);
    for (; fed < until; fed += 0.01) {
      const HeadAngles s = shafts(fed);
      registration.add_encoders(at(fed + 0.01), {s.pan + noise(random), s.tilt + noise(random)});
    }
  }

  HeadModel head = lab_head();
  HeadAngles hidden;
  StereoLenses lenses = lab_lenses();
  sim::TagRoom room{sim::TagRoom::lab_tags()};
  std::mt19937 random{3};
  double fed = 0;
};

TEST(Registration, EncodersAloneWithinOnePixel) {
  Lab lab({2e-4, -3e-4});  // what a calibration leaves
  Registration registration(lab.head, lab.lenses, {}, {});
  double worst = 0;
  for (int i = 0; i < 60; ++i) {
    const double t = 0.1 + i / 10.0;
    lab.feed(registration, t + 0.02);
    const auto result = registration.register_pair(at(t), {}, {});
    ASSERT_EQ(result.quality, RegistrationQuality::encoders);
    worst = std::max(worst, error_px(lab.lenses.left, lab.T_world_left(t), result.T_world_left));
  }
  EXPECT_LT(worst, 1.0);
}

TEST(Registration, TagsWithinThreeTenthsOfAPixelAtUnseenHeadPoses) {
  Lab lab({0.006, -0.004});
  Registration registration(lab.head, lab.lenses, lab.room.corners(), {});
  double square = 0, without = 0, predicted = 0;
  constexpr int kImages = 8;
  for (int i = 0; i < kImages; ++i) {
    const double t = 0.1 + i / 3.0;  // farther apart than the window: each pose stands on its own tags
    lab.feed(registration, t + 0.02);
    const Pose truth = lab.T_world_left(t);
    const auto result =
        registration.register_pair(at(t), lab.room.picture(lab_rays(), truth, 2, 2 * i),
                                   lab.room.picture(lab_rays(), truth * lab.lenses.T_left_right, 2, 2 * i + 1));
    EXPECT_EQ(result.quality, RegistrationQuality::tags) << i;
    const Pose kinematic = T_world_camera(lab.head, lab.shafts(t));
    square += std::pow(error_px(lab.lenses.left, truth, result.T_world_left), 2) / kImages;
    without += std::pow(error_px(lab.lenses.left, truth, kinematic), 2) / kImages;
    predicted += std::pow(result.predicted_px, 2) / kImages;
  }
  EXPECT_LT(std::sqrt(square), 0.3);
  EXPECT_GT(std::sqrt(without), 3);
  EXPECT_GT(std::sqrt(predicted), 0.4 * std::sqrt(square));
  EXPECT_LT(std::sqrt(predicted), 3 * std::sqrt(square));
}

TEST(Registration, HoldsThenForgetsThenIsLost) {
  Lab lab({0.006, -0.004});
  Registration registration(lab.head, lab.lenses, lab.room.corners(), {});
  lab.feed(registration, 0.5);
  const Pose truth = lab.T_world_left(0.3);
  const auto tags = registration.register_pair(at(0.3), lab.room.picture(lab_rays(), truth, 2, 1), {});
  ASSERT_EQ(tags.quality, RegistrationQuality::tags);
  lab.feed(registration, 1.2);
  const auto held = registration.register_pair(at(1), {}, {});
  EXPECT_EQ(held.quality, RegistrationQuality::held);
  EXPECT_GT(held.predicted_px, tags.predicted_px);
  EXPECT_LT(error_px(lab.lenses.left, lab.T_world_left(1), held.T_world_left), 1);
  lab.feed(registration, 60.2);
  const auto encoders = registration.register_pair(at(60), {}, {});
  EXPECT_EQ(encoders.quality, RegistrationQuality::encoders);
  EXPECT_GT(encoders.predicted_px, held.predicted_px);
  const auto lost = registration.register_pair(at(61), {}, {});
  EXPECT_EQ(lost.quality, RegistrationQuality::lost);
  EXPECT_GT(lost.predicted_px, 100);
  EXPECT_EQ(to_string(lost.quality), "lost");
}

TEST(Registration, RefusesARefinementThatContradictsTheTags) {
  Lab lab({0.006, -0.004});
  Registration registration(lab.head, lab.lenses, lab.room.corners(), {});
  lab.feed(registration, 0.5);
  const auto result =
      registration.register_pair(at(0.3), lab.room.picture(lab_rays(), lab.T_world_left(0.3), 2, 1), {});
  const Matrix6d sure = 1e-10 * Matrix6d::Identity();
  EXPECT_TRUE(Registration::agrees_with_tags(result, result.T_world_left, sure));
  const Pose beside = result.T_world_left * to_motion((Vector6d() << 0.01, 0, 0, 0, 0, 0).finished());
  EXPECT_FALSE(Registration::agrees_with_tags(result, beside, sure));
  EXPECT_TRUE(Registration::agrees_with_tags(RegistrationResult{}, beside, sure));
}

}  // namespace
}  // namespace foresight::registration_test

#include "calibration/registration/tag_correction.hpp"

#include <gtest/gtest.h>

#include <random>

#include "lab_head.hpp"
#include "sim/tag_room.hpp"

namespace foresight::tag_correction_test {
namespace {

RobotTime at(double s) {
  return RobotTime{} + seconds(s);
}

/// Tags whose corners all lie in the image, with noise.
std::vector<DetectedTag> seen_from(const TagMap& map, const Lens& lens, const Pose& T_world_camera, double noise,
                                   std::mt19937& random) {
  std::normal_distribution<double> normal(0, 1);
  std::vector<DetectedTag> out;
  for (const auto& [id, corners] : map) {
    DetectedTag tag{id, {}, 100};
    bool whole = true;
    for (std::size_t c = 0; c < 4; ++c) {
      const auto pixel = lens.project(T_world_camera.inverse() * corners[c]);
      whole = whole && pixel && pixel->x() > 0 && pixel->y() > 0 && pixel->x() < lens.width() - 1 &&
              pixel->y() < lens.height() - 1;
      if (whole) tag.corners[c] = *pixel + noise * Eigen::Vector2d(normal(random), normal(random));
    }
    if (whole) out.push_back(tag);
  }
  return out;
}

const Vector6d kTruth = (Vector6d() << 0.004, -0.003, 0.002, 0.003, -0.002, 0.004).finished();

struct Scene {
  StereoLenses lenses = lab_lenses();
  TagMap map = sim::TagRoom(sim::TagRoom::lab_tags()).corners();
  std::mt19937 random{7};

  void show(TagCorrection& correction, int images, double noise) {
    for (int i = 0; i < images; ++i) {
      const Pose T_kinematic = sim::T_world_head_left({0.02 * i, 0.5});
      const Pose T_left = T_kinematic * to_motion(kTruth);
      correction.add(at(i / 30.0), T_kinematic, seen_from(map, lenses.left, T_left, noise, random),
                     seen_from(map, lenses.right, T_left * lenses.T_left_right, noise, random));
    }
  }
};

TEST(TagCorrection, FindsAConstantCorrectionExactlyWithoutNoise) {
  Scene scene;
  TagCorrectionOptions options;
  options.prior_sigma.setConstant(10);
  TagCorrection correction(scene.lenses, scene.map, options);
  scene.show(correction, 3, 0);
  const auto found = correction.solve(at(2 / 30.0));
  ASSERT_TRUE(found.usable);
  EXPECT_LT((to_twist(found.T_left_corrected) - kTruth).norm(), 1e-6);
  EXPECT_EQ(found.gated, 0);
}

TEST(TagCorrection, ErrorsFitTheCovariance) {
  double chi2 = 0;
  constexpr int kRuns = 40;
  for (int run = 0; run < kRuns; ++run) {
    Scene scene;
    scene.random.seed(static_cast<unsigned>(run));
    TagCorrectionOptions options;
    options.drift_px_per_s = 0;
    TagCorrection correction(scene.lenses, scene.map, options);
    scene.show(correction, 4, options.corner_px);
    const auto found = correction.solve(at(3 / 30.0));
    const Vector6d error = to_twist(to_motion(kTruth).inverse() * found.T_left_corrected);
    chi2 += error.dot(found.covariance.ldlt().solve(error));
  }
  // 240 degrees of freedom: standard deviation 22. Huber's loss makes errors 5 % larger at most.
  EXPECT_GT(chi2, 160);
  EXPECT_LT(chi2, 330);
}

TEST(TagCorrection, LeavesOutAMovedTag) {
  Scene scene;
  TagCorrection correction(scene.lenses, scene.map, {});
  TagMap moved = scene.map;
  for (auto& corner : moved.at(4)) corner.y() += 0.02;
  std::swap(scene.map, moved);  // it truly stands elsewhere
  scene.show(correction, 3, 0.1);
  const auto found = correction.solve(at(2 / 30.0));
  EXPECT_EQ(found.gated, 6);  // in three images of two cameras
  EXPECT_LT((to_twist(found.T_left_corrected) - kTruth).norm(), 1e-3);
}

TEST(TagCorrection, IgnoresUnknownTagsAndForgetsOldOnes) {
  Scene scene;
  TagCorrection correction(scene.lenses, {}, {});
  scene.show(correction, 2, 0);
  EXPECT_FALSE(correction.newest());
  EXPECT_FALSE(correction.solve(at(1)).usable);
  TagCorrection known(scene.lenses, scene.map, {});
  scene.show(known, 2, 0);
  EXPECT_TRUE(known.newest());
  known.add(at(5), Pose::Identity(), {}, {});
  EXPECT_FALSE(known.newest());
}

}  // namespace
}  // namespace foresight::tag_correction_test

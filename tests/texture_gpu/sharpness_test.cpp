#include "texture_gpu/sharpness.hpp"

#include <gtest/gtest.h>

#include <random>
#include <vector>

namespace foresight::sharpness_test {
namespace {

/// Pages of an image that lies `off` px beside its place along each axis, root mean square, and has noise.
std::vector<AgreementSample> pages(double off, double noise, int count = 600, double contrast = 0.01) {
  std::mt19937 random(7);
  std::exponential_distribution<double> much(1 / contrast);
  std::gamma_distribution<double> spread(7.5, 1 / 7.5);  // a mean of fifteen squares
  std::vector<AgreementSample> samples;
  for (int i = 0; i < count; ++i) {
    const double gradient2 = much(random);
    const double difference2 = (2 * noise * noise + off * off * gradient2) * spread(random);
    samples.push_back({static_cast<float>(difference2), static_cast<float>(gradient2 + noise * noise / 2)});
    if (i % 3 == 0) samples.push_back({});  // seen from behind
  }
  return samples;
}

double share(double off, double noise) {
  SharpnessEstimator estimator;
  for (int image = 0; image < 5; ++image) estimator.update(pages(off, noise));
  return estimator.cubic_share();
}

TEST(Sharpness, IsLessTheFurtherImagesLieBesideTheirPlace) {
  EXPECT_EQ(share(0, 0), SharpnessEstimator::kMost);
  EXPECT_NEAR(share(0.2, 0), 1 - 6 * 0.04, 0.08);
  EXPECT_NEAR(share(0.3, 0), 1 - 6 * 0.09, 0.08);
  EXPECT_NEAR(share(0.37, 0), 1 - 6 * 0.137, 0.08);
  EXPECT_EQ(share(0.5, 0), SharpnessEstimator::kLeast) << "no softer than linear";
  EXPECT_EQ(share(0.7, 0), SharpnessEstimator::kLeast);
  EXPECT_EQ(share(3, 0), SharpnessEstimator::kLeast);
}

TEST(Sharpness, NoiseIsNoMisplacement) {
  EXPECT_NEAR(share(0, 0.03), SharpnessEstimator::kMost, 0.08);
  EXPECT_NEAR(share(0.33, 0.03), 1 - 6 * 0.109, 0.1);
}

TEST(Sharpness, WhatTellsNothingChangesNothing) {
  SharpnessEstimator estimator;
  EXPECT_FALSE(estimator.misplacement2());
  EXPECT_EQ(estimator.cubic_share(), SharpnessEstimator::kMost);
  estimator.update({});
  estimator.update(pages(1, 0, 20));
  estimator.update(std::vector<AgreementSample>(600));             // nothing is seen
  estimator.update(pages(1, 0.01, 600, 1e-5));                     // walls without a picture
  estimator.update(std::vector<AgreementSample>(600, {1, 0.1f}));  // all alike
  EXPECT_FALSE(estimator.misplacement2());
}

TEST(Sharpness, FollowsWithinSomeImages) {
  SharpnessEstimator estimator;
  for (int image = 0; image < 20; ++image) estimator.update(pages(0, 0));
  estimator.update(pages(0.6, 0));
  EXPECT_GT(estimator.cubic_share(), 0.7) << "one image is hardly believed";
  for (int image = 0; image < 40; ++image) estimator.update(pages(0.6, 0));
  EXPECT_EQ(estimator.cubic_share(), SharpnessEstimator::kLeast);
  for (int image = 0; image < 60; ++image) estimator.update(pages(0, 0));
  EXPECT_NEAR(estimator.cubic_share(), SharpnessEstimator::kMost, 0.01);
}

}  // namespace
}  // namespace foresight::sharpness_test

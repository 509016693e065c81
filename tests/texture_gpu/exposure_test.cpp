// The estimator alone, on made-up pages: a drifting gain, a vignette, outliers.
#include "texture_gpu/exposure.hpp"

#include <gtest/gtest.h>

#include <random>

namespace foresight::exposure_test {
namespace {

/// Pages of random brightness that wander over the picture, photographed with a drifting gain.
class Drift {
 public:
  struct Options {
    double a = 0, b = 0;   ///< true vignetting, log
    double noise = 0.005;  ///< of the log brightness
    double outliers = 0;   ///< share of pages whose brightness is anything
    bool moving = true;
    int pages = 300;
    double swing = 0.25;              ///< of the gain, log
    double bend = 0;                  ///< of the camera's response
    double period = 2 * M_PI / 0.07;  ///< images
  };
  explicit Drift(const Options& options) : options_(options), pages_(static_cast<std::size_t>(options.pages)) {
    std::uniform_real_distribution<double> unit(0, 1);
    for (AtlasPage& page : pages_) {
      pointers_.push_back(&page);
      texture_.push_back(std::log(0.15 + 0.5 * unit(random_)));
      place_.push_back(unit(random_));
      speed_.push_back(options.moving ? 0.02 * (unit(random_) - 0.5) : 0);
    }
  }

  double true_gain(int image) const { return options_.swing * std::sin(2 * M_PI * image / options_.period); }

  void show(ExposureEstimator& estimator, int image) {
    std::normal_distribution<double> noise(0, options_.noise);
    std::uniform_real_distribution<double> unit(0, 1);
    std::vector<ExposureSample> samples;
    for (std::size_t i = 0; i < pages_.size(); ++i) {
      // To and fro between the picture's centre and its corner.
      const double r = std::abs(std::remainder(place_[i] + speed_[i] * image, 2.0));
      const double r2 = r * r;
      double log_brightness = texture_[i] + true_gain(image) + r2 * (options_.a + r2 * options_.b) + noise(random_);
      if (unit(random_) < options_.outliers) log_brightness = std::log(0.05 + 0.9 * unit(random_));
      double value = std::exp(log_brightness);
      value /= std::pow(1 + options_.bend * std::pow(value, 4), 0.25);
      if (value > 0.97) value = ExposureSample::kWhite + std::min(value, 1.0);
      samples.push_back({static_cast<float>(value), static_cast<float>(r2)});
    }
    estimator.update(samples, pointers_, image);
  }

 private:
  Options options_;
  std::mt19937 random_{11};
  std::vector<AtlasPage> pages_;
  std::vector<AtlasPage*> pointers_;
  std::vector<double> texture_, place_, speed_;
};

double worst_gain_error(const Drift::Options& options, int images, int from) {
  Drift drift(options);
  ExposureEstimator estimator;
  double worst = 0;
  for (int image = 0; image < images; ++image) {
    drift.show(estimator, image);
    if (image >= from) worst = std::max(worst, std::abs(estimator.log_gain() - drift.true_gain(image)));
  }
  return worst;
}

TEST(ExposureEstimator, FollowsADriftingGainWithinAPercent) {
  EXPECT_LT(worst_gain_error({}, 100, 1), 0.01);
  EXPECT_LT(worst_gain_error({.moving = false}, 100, 1), 0.01);
}

TEST(ExposureEstimator, DoesNotCareAboutOutliers) {
  EXPECT_LT(worst_gain_error({.outliers = 0.2}, 100, 1), 0.02);
  Drift drift({.outliers = 0.2});
  ExposureEstimator estimator;
  for (int image = 0; image < 100; ++image) drift.show(estimator, image);
  EXPECT_LT(std::abs(estimator.vignetting_log(1)), 0.02) << "outliers look like vignetting";
}

TEST(ExposureEstimator, LearnsVignettingFromPagesThatMove) {
  const Drift::Options options{.a = -0.25, .b = -0.15};
  Drift drift(options);
  ExposureEstimator estimator;
  for (int image = 0; image < 200; ++image) drift.show(estimator, image);
  for (double r2 : {0.1, 0.3, 0.5, 0.8, 1.0})
    EXPECT_NEAR(estimator.vignetting_log(r2), r2 * (options.a + r2 * options.b), 0.02) << "at r^2 = " << r2;
}

// What is far beyond its own error helps long before that error is small.
TEST(ExposureEstimator, AStrongVignettingIsKnownAfterAFewImages) {
  Drift drift({.a = -0.6, .noise = 0.02, .pages = 80});
  ExposureEstimator estimator;
  for (int image = 0; image < 8; ++image) drift.show(estimator, image);
  EXPECT_NEAR(estimator.vignetting_log(1), -0.6, 0.12);
}

TEST(ExposureEstimator, InventsNoVignetting) {
  for (bool moving : {true, false}) {
    Drift drift({.moving = moving});
    ExposureEstimator estimator;
    for (int image = 0; image < 200; ++image) {
      drift.show(estimator, image);
      ASSERT_LT(std::abs(estimator.vignetting_log(1)), 0.01) << "image " << image << (moving ? ", moving" : ", still");
    }
  }
}

// White pages drop out and come back, references are handed on a hundred times: no gain creeps in, nor
// with a response that bends towards white.
TEST(ExposureEstimator, DoesNotDrift) {
  for (const double bend : {0.0, 0.5}) {
    Drift drift({.noise = 0.02, .outliers = 0.02, .swing = 0.5, .bend = bend, .period = 97});
    ExposureEstimator estimator;
    double worst = 0;
    for (int image = 0; image < 3000; ++image) {
      drift.show(estimator, image);
      worst = std::max(worst, std::abs(estimator.log_gain() - drift.true_gain(image)));
    }
    EXPECT_LT(worst, bend > 0 ? 0.2 : 0.06) << bend;
  }
}

TEST(ExposureEstimator, WhiteAndBlackImagesAreKnownForWhatTheyAre) {
  for (const bool white : {true, false}) {
    ExposureEstimator estimator;
    std::vector<AtlasPage> pages(200);
    std::vector<AtlasPage*> pointers;
    for (AtlasPage& page : pages) pointers.push_back(&page);
    const auto show = [&](float brightness, std::int64_t image) {
      estimator.update(std::vector<ExposureSample>(200, {brightness, 0}), pointers, image);
    };
    show(0.3f, 0);
    show(0.3f, 1);
    ASSERT_NEAR(estimator.log_gain(), 0, 1e-6);
    show(white ? ExposureSample::kWhite + 1 : 0, 2);
    if (white)
      EXPECT_GE(estimator.log_gain(), std::log(0.98 / 0.3));
    else
      EXPECT_LE(estimator.log_gain(), std::log(1 / 255. / 0.3));
    show(0.3f, 40);  // old enough for new references, which must not come from the bad image
    EXPECT_NEAR(estimator.log_gain(), 0, 1e-6) << white;
  }
}

TEST(ExposureEstimator, KeepsTheLastGainWhereFewPagesCompare) {
  ExposureEstimator estimator;
  Drift drift({});
  drift.show(estimator, 0);
  drift.show(estimator, 20);
  const double gain = estimator.log_gain();
  ASSERT_GT(gain, 0.1);
  std::vector<AtlasPage> few(29);
  std::vector<AtlasPage*> pointers;
  for (AtlasPage& page : few)
    pointers.push_back(&page),
        page.exposure = {.log_brightness = std::log(0.2f), .log_surface = std::log(0.2f), .image = 0};
  estimator.update(std::vector<ExposureSample>(29, {0.8f, 0}), pointers, 21);
  EXPECT_EQ(estimator.log_gain(), gain);
  // What is too dark, was not seen, or is no page does not count either.
  std::vector<AtlasPage*> mixed(100, nullptr);
  for (std::size_t i = 0; i < 29; ++i) mixed[i] = pointers[i];
  estimator.update(std::vector<ExposureSample>(100, {0.8f, 0}), mixed, 22);
  EXPECT_EQ(estimator.log_gain(), gain);
}

TEST(ExposureEstimator, RenewsReferencesAfterThirtyImages) {
  ExposureEstimator estimator;
  AtlasPage page;
  AtlasPage* pointer = &page;
  const auto show = [&](float brightness, std::int64_t image) {
    const ExposureSample sample{brightness, 0.3f};
    estimator.update(std::span(&sample, 1), std::span(&pointer, 1), image);
  };
  show(0.4f, 5);
  EXPECT_EQ(page.exposure.image, 5);
  EXPECT_FLOAT_EQ(page.exposure.log_brightness, std::log(0.4f));
  EXPECT_FLOAT_EQ(page.exposure.radius2, 0.3f);
  show(0.5f, 34);
  EXPECT_EQ(page.exposure.image, 5);
  show(-1, 35);
  EXPECT_EQ(page.exposure.image, 5) << "an unseen page is no reference";
  show(0.6f, 35);
  EXPECT_EQ(page.exposure.image, 35);
  EXPECT_FLOAT_EQ(page.exposure.log_brightness, std::log(0.6f));
}

}  // namespace
}  // namespace foresight::exposure_test

// A camera that changes its white balance, on made-up pages and images.
#include "texture_gpu/white_balance.hpp"

#include <gtest/gtest.h>

#include "tests/texture_gpu/coloured_pages.hpp"

namespace foresight::white_balance_test {
namespace {

/// A camera that shows pages with red and blue exp(log) times as large as at first, corrected by WhiteBalance.
class Pages : public ColouredPages {
 public:
  using ColouredPages::ColouredPages;
  bool learn(WhiteBalance& balance, const Eigen::Vector2d& log, float outliers = 0) {
    const Eigen::Vector3f on_image = balance.factors_on_image();
    return balance.learn(samples(log.x() - std::log(on_image.x()), log.y() - std::log(on_image.z()), outliers),
                         pages());
  }
};

const cv::Mat kGrey{4, 4, CV_8UC3, cv::Scalar(100, 100, 100)};

double error(const WhiteBalance& balance, const Eigen::Vector2d& log) {
  const Eigen::Vector3f factors = balance.factors();
  return Eigen::Vector2d(std::log(factors.x()) - log.x(), std::log(factors.z()) - log.y()).cwiseAbs().maxCoeff();
}

TEST(WhiteBalance, FollowsACameraThatChangesItAndDoesNotWalkAway) {
  for (const float outliers : {0.0f, 0.2f}) {
    Pages pages(300);
    WhiteBalance balance;
    double worst = 0;
    for (int image = 0; image < 600; ++image) {
      const double swing = std::sin(2 * M_PI * image / 90);
      balance.apply(kGrey);
      pages.learn(balance, {0.1 * swing, -0.08 * swing}, outliers);
      worst = std::max(worst, error(balance, {0.1 * swing, -0.08 * swing}));
    }
    EXPECT_LT(worst, 0.025) << outliers << ", noise, and what does not count";
    for (int image = 0; image < 3; ++image) {
      balance.apply(kGrey);
      pages.learn(balance, {0.1, -0.08}, outliers);
    }
    EXPECT_LT(error(balance, {0.1, -0.08}), 0.006) << outliers;
  }
}

TEST(WhiteBalance, LeavesACameraAloneThatKeepsIt) {
  Pages pages(300);
  WhiteBalance balance;
  for (int image = 0; image < 300; ++image) {
    EXPECT_EQ(balance.apply(kGrey).data, kGrey.data);
    EXPECT_FALSE(pages.learn(balance, {0, 0}, 0.2f));
    ASSERT_EQ(balance.factors(), Eigen::Vector3f(1, 1, 1)) << "image " << image;
  }
}

TEST(WhiteBalance, AnImageThatDiffersMuchIsCorrectedAgain) {
  Pages pages(300);
  WhiteBalance balance;
  balance.apply(kGrey);
  pages.learn(balance, {0, 0});
  balance.apply(kGrey);
  EXPECT_TRUE(pages.learn(balance, {0.2, -0.1}));
  EXPECT_EQ(balance.factors_on_image(), Eigen::Vector3f(1, 1, 1)) << "its pixels are as they came";
  const cv::Mat seen(4, 4, CV_8UC3, cv::Scalar(100 * std::exp(-0.1), 100, 100 * std::exp(0.2)));
  const cv::Vec3b corrected = balance.apply(seen).at<cv::Vec3b>(0);
  for (int channel = 0; channel < 3; ++channel) EXPECT_NEAR(corrected[channel], 100, 1.5);
  EXPECT_EQ(balance.factors_on_image(), balance.factors());
  EXPECT_FALSE(pages.learn(balance, {0.2, -0.1}));
}

TEST(WhiteBalance, IsThatOfTheLastImageWhereFewPagesTell) {
  Pages pages(300);
  WhiteBalance balance;
  for (const double red : {0.0, 0.2}) {
    balance.apply(kGrey);
    pages.learn(balance, {red, 0});
  }
  std::vector<AtlasPage> few(29);
  std::vector<AtlasPage*> pointers;
  for (AtlasPage& page : few) pointers.push_back(&page);
  const std::vector<ExposureSample> samples(29, {0.4f, 0, 0.3f, 0.3f});
  for (int image = 0; image < 3; ++image) balance.learn(samples, pointers);
  EXPECT_LT(error(balance, {0.2, 0}), 0.01);
}

TEST(WhiteBalance, HasNothingToSayOfGreyImages) {
  WhiteBalance balance;
  Pages pages(300);
  pages.learn(balance, {0, 0});
  pages.learn(balance, {0.3, 0.3});
  const cv::Mat grey(4, 4, CV_8UC1, cv::Scalar(90));
  EXPECT_EQ(balance.apply(grey).data, grey.data);
  EXPECT_EQ(balance.factors_on_image(), Eigen::Vector3f(1, 1, 1));
}

}  // namespace
}  // namespace foresight::white_balance_test

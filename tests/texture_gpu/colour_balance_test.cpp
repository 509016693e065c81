// Cameras of different white balance, on made-up pages and images.
#include "texture_gpu/colour_balance.hpp"

#include <gtest/gtest.h>

#include "tests/texture_gpu/coloured_pages.hpp"
#include "texture_gpu/white_balance.hpp"

namespace foresight::colour_balance_test {
namespace {

/// Pages which a left camera and a right one see, each colour multiplied in the right one's.
class Pages : public ColouredPages {
 public:
  using ColouredPages::ColouredPages;
  void remember() { WhiteBalance().learn(samples(), pages()); }
  bool learn(ColourBalance& balance, double red, double blue) {
    const auto factors = balance.factors().value_or(Eigen::Vector2d(1, 1));
    return balance.learn(samples(std::log(red * factors.x()), std::log(blue * factors.y())), pages());
  }
};

cv::Mat even(double blue, double green, double red) {
  return {4, 4, CV_8UC3, cv::Scalar(blue, green, red)};
}

TEST(ColourBalance, LearnsWhatTheRightCameraMakesOfColours) {
  Pages pages(200);
  pages.remember();
  ColourBalance balance;
  const cv::Mat grey = even(100, 100, 100);
  for (int image = 0; image < 30; ++image) {
    balance.apply(grey);
    pages.learn(balance, 0.9, 1.2);
  }
  ASSERT_TRUE(balance.factors());
  EXPECT_NEAR(balance.factors()->x(), 1 / 0.9, 0.005);
  EXPECT_NEAR(balance.factors()->y(), 1 / 1.2, 0.005);
  EXPECT_EQ(balance.apply(even(120, 100, 90)).at<cv::Vec3b>(0), cv::Vec3b(100, 100, 100));
  EXPECT_EQ(balance.apply(even(255, 255, 255)).at<cv::Vec3b>(0), cv::Vec3b(255, 255, 255)) << "white stays";
  EXPECT_NEAR(balance.apply(even(255, 200, 180)).at<cv::Vec3b>(0)[0], 255 / 1.2, 2) << "no other does";
}

TEST(ColourBalance, LeavesCamerasAloneThatAreAlike) {
  Pages pages(200);
  pages.remember();
  ColourBalance balance;
  const cv::Mat image = even(80, 120, 60);
  for (int i = 0; i < 30; ++i) {
    EXPECT_EQ(balance.apply(image).data, image.data);
    pages.learn(balance, 1.01, 0.99);
  }
  EXPECT_FALSE(balance.factors());
}

TEST(ColourBalance, TheFirstPairIsCorrectedAtOnce) {
  Pages pages(200);
  pages.remember();
  ColourBalance balance;
  balance.apply(even(140, 90, 70));
  EXPECT_TRUE(pages.learn(balance, 0.7, 1.4)) << "that image is to be corrected anew";
  balance.apply(even(140, 90, 70));
  EXPECT_FALSE(pages.learn(balance, 0.7, 1.4));
  EXPECT_NEAR(balance.factors()->x(), 1 / 0.7, 0.02);
  EXPECT_NEAR(balance.factors()->y(), 1 / 1.4, 0.02);
}

TEST(ColourBalance, LearnsNothingOfFewPages) {
  Pages pages(20);
  pages.remember();
  ColourBalance balance;
  balance.apply(even(100, 100, 100));
  pages.learn(balance, 0.5, 2);
  EXPECT_FALSE(balance.factors());
  Pages(200).learn(balance, 0.5, 2);
  EXPECT_FALSE(balance.factors()) << "the left camera has seen none of them";
}

TEST(ColourBalance, HasNothingToSayOfGreyImages) {
  ColourBalance balance;
  const cv::Mat grey(4, 4, CV_8UC1, cv::Scalar(50));
  EXPECT_EQ(balance.apply(grey).data, grey.data);
  EXPECT_FALSE(balance.factors());
}

}  // namespace
}  // namespace foresight::colour_balance_test

#include "texture_gpu/skyline_packer.hpp"

#include <gtest/gtest.h>

#include <random>

namespace foresight::skyline_packer_test {
namespace {

TEST(SkylinePacker, RectanglesDoNotOverlapAndWasteLittle) {
  std::mt19937 random(1);
  for (int round = 0; round < 20; ++round) {
    std::vector<cv::Size> sizes;
    int area = 0;
    for (int i = 0; i < 20 * (round + 1); ++i) {
      sizes.emplace_back(4 + static_cast<int>(random() % 60), 4 + static_cast<int>(random() % 60));
      area += sizes.back().area();
    }
    cv::Size used;
    const auto corners = pack_skyline(sizes, 2000, used);
    ASSERT_TRUE(corners);
    cv::Mat taken(used, CV_8U, cv::Scalar(0));
    for (std::size_t i = 0; i < sizes.size(); ++i) {
      const cv::Rect place((*corners)[i], sizes[i]);
      ASSERT_EQ(place & cv::Rect({}, used), place);
      ASSERT_EQ(cv::countNonZero(taken(place)), 0);
      taken(place).setTo(1);
    }
    EXPECT_LT(used.area(), 1.35 * area) << sizes.size() << " rectangles";
  }
}

TEST(SkylinePacker, FillsASquareToTheLastPixel) {
  cv::Size used;
  EXPECT_TRUE(pack_skyline(std::vector<cv::Size>(16, {8, 8}), 32, used));
  EXPECT_EQ(used, cv::Size(32, 32));
  EXPECT_FALSE(pack_skyline(std::vector<cv::Size>(17, {8, 8}), 32, used));
  EXPECT_FALSE(pack_skyline(std::vector<cv::Size>{{1, 33}}, 32, used)) << "too high";
  EXPECT_FALSE(pack_skyline(std::vector<cv::Size>{{33, 1}}, 32, used)) << "too wide";
}

TEST(SkylinePacker, PutsLowOnesBesideHighOnes) {
  cv::Size used;
  ASSERT_TRUE(pack_skyline(std::vector<cv::Size>{{10, 100}, {80, 10}, {80, 20}, {80, 30}, {80, 40}}, 100, used));
  EXPECT_EQ(used, cv::Size(95, 100)) << "the square root of their area is 94.9";
}

}  // namespace
}  // namespace foresight::skyline_packer_test

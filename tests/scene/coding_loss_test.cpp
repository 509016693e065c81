// Who has an image and what came of it tells where detail is lost; who hears it believes well-formed answers only.
#include "scene/coding_loss.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>

namespace foresight::coding_loss_test {
namespace {

constexpr int kTile = 16;  // px

cv::Mat image(int level = 100) {
  return {kLossRows * kTile, kLossColumns * kTile, CV_8UC3, cv::Scalar(level, level, level)};
}
/// So many pixels of the tile, `levels` brighter.
void change(cv::Mat& image, cv::Point tile, int pixels, int levels) {
  for (int i = 0; i < pixels; ++i)
    image.at<cv::Vec3b>(tile.y * kTile + i / kTile, tile.x * kTile + i % kTile) += cv::Vec3b::all(levels);
}

TEST(CodingLoss, IsToldByTile) {
  cv::Mat came = image();
  change(came, {2, 1}, kTile * kTile, 9);    // all of it, by too little
  change(came, {19, 0}, kTile * kTile, 40);  // all
  change(came, {0, 14}, 24, 40);             // 9.4 %
  change(came, {7, 7}, 1, 40);               // 0.4 %
  const cv::Mat loss = coding_loss(image(), came);
  cv::Mat expected = cv::Mat::zeros(kLossRows, kLossColumns, CV_8UC1);
  expected.at<std::uint8_t>(0, 19) = kLossSteps - 1;
  expected.at<std::uint8_t>(14, 0) = 4;
  EXPECT_EQ(cv::countNonZero(loss != expected), 0) << loss;
}

TEST(CodingLoss, AStepIsOfTheShareThatItStandsFor) {
  for (int step = 1; step < kLossSteps - 1; ++step) {
    cv::Mat came = image();
    change(came, {3, 3}, static_cast<int>(std::lround(share_lost(step) * kTile * kTile)), 40);
    EXPECT_EQ(coding_loss(image(), came).at<std::uint8_t>(3, 3), step);
  }
}

TEST(CodingLoss, PixelsOfGoodTilesAreKept) {
  cv::Mat loss = cv::Mat::zeros(kLossRows, kLossColumns, CV_8UC1);
  loss.at<std::uint8_t>(5, 4) = 1;
  const cv::Mat kept = kept_mask(loss, image().size());
  EXPECT_EQ(cv::countNonZero(~kept), kTile * kTile);
  EXPECT_EQ(cv::countNonZero(kept({4 * kTile, 5 * kTile, kTile, kTile})), 0);
  EXPECT_EQ(cv::countNonZero(~kept_mask({}, {33, 21})), 0) << "nothing is known to be lost";
}

// Left halves of tiles are flat and stay, of right halves, which are striped, a part of a stripe is smoothed away.
TEST(CodingLoss, IsCountedByContrast) {
  cv::Mat taken = image();
  for (int x = 0; x < taken.cols; ++x)
    if (x % kTile >= kTile / 2 && x % 2 == 0) taken.col(x) = cv::Scalar(140, 140, 140);
  cv::Mat came = taken.clone();
  for (int y = 0; y < came.rows; y += 4)
    for (int x = kTile / 2; x < came.cols; x += kTile) came.at<cv::Vec3b>(y, x) = {100, 100, 100};
  const cv::Mat steps = coding_loss(taken, came);
  ASSERT_EQ(cv::countNonZero(steps != 2), 0) << "1.6 %";
  LossCount count;
  EXPECT_EQ(count.shares(), even_loss_shares());
  for (int i = 0; i < 20; ++i) count.add(taken, came, steps);
  const auto of_step = count.shares()[1];
  EXPECT_LT(of_step[0], 2e-3) << "flat";
  EXPECT_GT(of_step[3], 0.2) << "among stripes";
  EXPECT_EQ(count.shares()[0], even_loss_shares()[0]) << "no tile is of this step";
  for (int i = 0; i < 100; ++i) count.add(taken, taken, coding_loss(taken, taken));
  EXPECT_NEAR(count.shares()[1][0], share_lost(2), 1e-3) << "what was long ago tells nothing";
}

TEST(CodingLoss, SharesFitBytes) {
  LossShares shares = even_loss_shares();
  shares[3] = {0, 0.001, 0.03, 0.5, 1};
  const auto back = loss_shares_of(to_bytes(shares));
  ASSERT_TRUE(back);
  for (std::size_t i = 0; i < shares.size(); ++i)
    for (std::size_t k = 0; k < shares[i].size(); ++k)
      EXPECT_NEAR((*back)[i][k], shares[i][k], 0.13 * shares[i][k]) << i << ' ' << k;
  EXPECT_EQ(loss_shares_of({}), even_loss_shares());
  EXPECT_FALSE(loss_shares_of(std::vector<std::uint8_t>(kToldSteps * kLossContrasts + 1)));
}

TEST(Contrast, IsToldInSteps) {
  cv::Mat grey(9, 40, CV_8UC1, cv::Scalar(100));
  grey.colRange(20, 40) = 120;
  const cv::Mat steps = contrast_steps(grey);
  const double levels = std::sqrt(3 * 400 / 8.0);  // three of eight neighbours are on the other side
  for (int y = 0; y < grey.rows; ++y)
    for (int x = 0; x < grey.cols; ++x)
      EXPECT_EQ(steps.at<uchar>(y, x), x == 19 || x == 20 ? static_cast<int>(4 * std::log2(1 + levels / 3)) : 0);
  grey.colRange(20, 40) = 255;
  EXPECT_EQ(contrast_steps(grey).at<uchar>(0, 20), kContrastSteps - 1);
  EXPECT_NEAR(contrast_levels(4), 3.55, 0.01);
}

TEST(CodingLoss, WhatOthersTellIsLookedAt) {
  std::array<std::uint8_t, kLossRows * kLossColumns> steps{};
  steps[kLossColumns + 3] = kLossSteps - 1;
  const auto loss = loss_of(steps);
  ASSERT_TRUE(loss);
  EXPECT_EQ(loss->at<std::uint8_t>(1, 3), kLossSteps - 1);
  EXPECT_EQ(cv::countNonZero(*loss), 1);
  EXPECT_TRUE(loss_of({}) && loss_of({})->empty());
  EXPECT_FALSE(loss_of(std::span(steps).first(steps.size() - 1)));
  steps[0] = kLossSteps;
  EXPECT_FALSE(loss_of(steps));
}

}  // namespace
}  // namespace foresight::coding_loss_test

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

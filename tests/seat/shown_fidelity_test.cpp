// What was shown is compared with the image of its own instant, and what is learnt of it holds for the next pictures.
#include "seat/shown_fidelity.hpp"

#include <gmock/gmock.h>

#include <opencv2/imgproc.hpp>
#include <random>

#include "display/trust_pass.hpp"

namespace foresight::shown_fidelity_test {
namespace {

using namespace std::chrono_literals;

constexpr int kWidth = 96, kHeight = 64;

RobotTime at(Duration time) {
  return RobotTime{} + time;
}
cv::Mat image(int level = 120) {
  return {kHeight, kWidth, CV_8UC3, cv::Scalar(level, level, level)};
}
/// All of it coloured by images, without doubt.
RememberedView view(Duration instant, int level = 120) {
  return {at(instant), cv::Mat(kHeight, kWidth, CV_8UC4, cv::Scalar(level, level, level, 255)),
          cv::Mat::zeros(kHeight, kWidth, CV_8UC1)};
}

TEST(ShownFidelity, ComparesWithTheImageOfTheSameInstant) {
  ShownFidelity fidelity;
  for (int i = 0; i < 10; ++i) fidelity.shown(view(i * 100ms, 100 + 10 * i));
  EXPECT_FALSE(fidelity.arrived(at(-200ms), image()));
  const auto third = fidelity.arrived(at(312ms), image(130));
  ASSERT_TRUE(third);
  EXPECT_EQ(third->instant, at(300ms));
  EXPECT_EQ(third->psnr_db, 100);
  EXPECT_FALSE(fidelity.arrived(at(300ms), image())) << "it was used";
  EXPECT_FALSE(fidelity.arrived(at(350ms), image())) << "nothing was shown for it";
  const auto fifth = fidelity.arrived(at(500ms), image(140));
  ASSERT_TRUE(fifth);
  EXPECT_NEAR(fifth->psnr_db.value(), 20 * std::log10(255 / 10.0), 0.01);
}

TEST(ShownFidelity, SaysWhereItWasWrong) {
  ShownFidelity fidelity;
  fidelity.shown(view(100ms));
  cv::Mat truth = image();
  const cv::Rect there(kWidth - 14, kHeight - 14, 10, 10);
  truth(there) = cv::Scalar(160, 160, 160);
  const auto out = fidelity.arrived(at(100ms), truth);
  ASSERT_TRUE(out);
  EXPECT_EQ(place_of(out->worst), "bottom right");
  EXPECT_EQ(out->patches.at<uchar>(kHeight - 9, kWidth - 9), 255);
  EXPECT_EQ(out->patches.at<uchar>(10, 10), 0);
  EXPECT_NEAR(out->exact_wrong, 100.0 / (kWidth * kHeight), 1e-9);
  EXPECT_EQ(place_of(0), "top left");
  EXPECT_EQ(place_of(Fidelity::kColumns * 2 + 3), "middle");
}

// An outline that is a pixel aside is no thing that moves by itself.
TEST(ShownFidelity, ALineIsNoPatch) {
  ShownFidelity fidelity;
  fidelity.shown(view(100ms));
  cv::Mat truth = image();
  cv::line(truth, {0, 20}, {kWidth, 20}, cv::Scalar(220, 220, 220), 1);
  EXPECT_EQ(cv::countNonZero(fidelity.arrived(at(100ms), truth)->patches), 0);
}

// Pixels are wrong the more often, the more doubt they carry: the limit goes to where the wrong ones are few enough.
TEST(ShownFidelity, LearnsHowMuchDoubtIsStillRight) {
  ShownFidelity fidelity;
  std::mt19937 random(1);
  std::uniform_int_distribution<int> doubt(0, 120), percent(0, 99);
  const auto round = [&](int i, int wrong_beyond) {
    RememberedView shown = view(i * 100ms);
    cv::Mat truth = image();
    for (int y = 0; y < kHeight; ++y)
      for (int x = 0; x < kWidth; ++x) {
        const int d = doubt(random);
        shown.doubt.at<uchar>(y, x) = static_cast<uchar>(d);
        if (d > wrong_beyond && percent(random) < 30) truth.at<cv::Vec3b>(y, x) = {180, 180, 180};
      }
    fidelity.shown(std::move(shown));
    return fidelity.arrived(at(i * 100ms), truth)->exact_wrong;
  };
  for (int i = 0; i < 20; ++i) round(i, 20);
  EXPECT_NEAR(fidelity.limit(), 21, 1.5);
  EXPECT_LT(round(20, 20), 0.02);
  for (int i = 21; i < 60; ++i) round(i, 6);
  EXPECT_NEAR(fidelity.limit(), 6.5, 1.5) << "it has become worse";
  for (int i = 60; i < 120; ++i) round(i, 110);
  EXPECT_EQ(fidelity.limit(), FidelityOptions{}.most_limit) << "all is well: not beyond what was asked for";
}

TEST(ShownFidelity, WhatNoImageColouredIsLeftOut) {
  ShownFidelity fidelity;
  RememberedView shown = view(100ms);
  shown.picture(cv::Rect(0, 0, kWidth / 2, kHeight)) = cv::Scalar(0, 0, 0, 128);
  shown.doubt.colRange(kWidth - 10, kWidth) = kUnconfirmed;
  fidelity.shown(std::move(shown));
  const auto out = fidelity.arrived(at(100ms), image());
  ASSERT_TRUE(out);
  EXPECT_EQ(out->psnr_db, 100);
  EXPECT_NEAR(out->exact_share, (kWidth / 2.0 - 10) / (kWidth / 2.0), 1e-9);
}

TEST(ShownFidelity, BearsWhatDoesNotFit) {
  ShownFidelity fidelity({.kept = 3});
  fidelity.shown(view(100ms));
  EXPECT_FALSE(fidelity.arrived(at(100ms), cv::Mat(10, 10, CV_8UC3, cv::Scalar::all(1)))) << "of another size";
  for (int i = 0; i < 100; ++i) fidelity.shown(view(i * 100ms));
  EXPECT_FALSE(fidelity.arrived(at(9600ms), image())) << "only so many are kept";
  EXPECT_TRUE(fidelity.arrived(at(9700ms), image()));
  fidelity.shown(view(5ms));  // the robot's clock began anew
  EXPECT_TRUE(fidelity.arrived(at(5ms), image()));
  RememberedView dark = view(200ms);
  dark.picture = cv::Scalar::all(0);
  fidelity.shown(std::move(dark));
  const auto nothing = fidelity.arrived(at(200ms), image());
  ASSERT_TRUE(nothing);
  EXPECT_FALSE(nothing->psnr_db);
}

}  // namespace
}  // namespace foresight::shown_fidelity_test

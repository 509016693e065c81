#include "calibration/target/capture_picture.hpp"

#include <gtest/gtest.h>

namespace foresight::capture_picture_test {
namespace {

// Where an image of 4:3 lies.
const cv::Rect kImage(33, 132, 875, 656);

CaptureMoment moment() {
  CaptureMoment out;
  out.left = cv::Mat(480, 640, CV_8U, cv::Scalar(100));
  out.progress.views = 3, out.progress.views_wanted = 15;
  out.progress.seen = cv::Mat::ones(3, 4, CV_8U);
  out.outcome.verdict.reason = "hold it still";
  return out;
}

cv::Vec3b colour(const cv::Mat& picture, double x, double y) {
  return picture.at<cv::Vec3b>(kImage.y + cvRound(y * kImage.height), kImage.x + cvRound(x * kImage.width));
}

bool amber(const cv::Vec3b& bgr) {
  return bgr[2] > bgr[0] + 15;
}

TEST(CapturePicture, MarksWhatIsMissing) {
  CaptureMoment wanted = moment();
  wanted.progress.seen.at<uchar>(0, 3) = wanted.progress.seen.at<uchar>(2, 1) = 0;
  wanted.progress.wish = {CaptureWish::Kind::place, "", "the upper right corner", 0, {3, 0}};
  const cv::Mat picture = capture_picture(wanted);
  ASSERT_EQ(picture.size(), cv::Size(kCapturePictureWidth, kCapturePictureHeight));
  for (int row = 0; row < 3; ++row)
    for (int column = 0; column < 4; ++column) {
      const bool missing = wanted.progress.seen.at<uchar>(row, column) == 0;
      EXPECT_EQ(amber(colour(picture, (column + 0.1) / 4, (row + 0.8) / 3)), missing) << row << " " << column;
    }
  EXPECT_GT(colour(picture, 3.1 / 4, 0.8 / 3)[2], colour(picture, 1.1 / 4, 2.8 / 3)[2]) << "the next one stands out";
}

TEST(CapturePicture, OutlinesViewsAndFramesATakenOne) {
  CaptureMoment plain = moment(), taken = moment();
  taken.progress.outlines = {{{200, 200}, {400, 200}, {400, 300}}};
  taken.outcome.verdict = {true, ""};
  const cv::Mat before = capture_picture(plain), after = capture_picture(taken);
  const cv::Vec3b line = colour(after, 300.5 / 640, 200.5 / 480), frame = colour(after, 0.5, 0.002);
  EXPECT_GT(line[1], line[2] + 50);
  EXPECT_GT(frame[1], frame[2] + 50);
  EXPECT_EQ(colour(before, 300.5 / 640, 200.5 / 480), cv::Vec3b(100, 100, 100));
  EXPECT_EQ(colour(after, 0.1, 0.9), cv::Vec3b(100, 100, 100));
}

TEST(CapturePicture, EveryWishLooksDifferent) {
  std::vector<cv::Mat> pictures;
  for (const auto kind : {CaptureWish::Kind::none, CaptureWish::Kind::first, CaptureWish::Kind::size}) {
    CaptureMoment of = moment();
    of.progress.wish.kind = kind;
    pictures.push_back(capture_picture(of));
  }
  for (int side = 0; side < 4; ++side) {
    CaptureMoment of = moment();
    of.progress.wish = {CaptureWish::Kind::tilt, "", "left", side, {}};
    pictures.push_back(capture_picture(of));
  }
  for (std::size_t a = 0; a < pictures.size(); ++a)
    for (std::size_t b = 0; b < a; ++b)
      EXPECT_GT(cv::norm(pictures[a](kImage), pictures[b](kImage)), 1000) << a << " " << b;
}

TEST(CapturePicture, TakesAnyShapeOfImage) {
  for (const cv::Size size : {cv::Size(1920, 1200), cv::Size(480, 800), cv::Size(2000, 400)}) {
    CaptureMoment of = moment();
    of.left = of.right = cv::Mat(size, CV_8UC3, cv::Scalar(10, 20, 30));
    of.progress.uncertainty = cv::Mat(24, 32, CV_64F, cv::Scalar(0.2));
    EXPECT_EQ(capture_picture(of).size(), cv::Size(1280, 800));
  }
}

}  // namespace
}  // namespace foresight::capture_picture_test

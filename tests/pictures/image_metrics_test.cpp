#include "pictures/image_metrics.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <opencv2/imgproc.hpp>

namespace foresight::image_metrics_test {
namespace {

cv::Mat textured(int width, int height, int seed) {
  cv::Mat noise(height, width, CV_8UC3), smooth;
  cv::RNG rng(seed);
  rng.fill(noise, cv::RNG::UNIFORM, 0, 256);
  cv::GaussianBlur(noise, smooth, {0, 0}, 2);
  cv::normalize(smooth, smooth, 10, 245, cv::NORM_MINMAX);
  return smooth;
}

cv::Mat all_seen(const cv::Mat& image) {
  return cv::Mat(image.size(), CV_8U, cv::Scalar(255));
}

// SSIM straight from the paper and the contract, one window at a time, in double precision.
double reference_ssim(const cv::Mat& a_bgr, const cv::Mat& b_bgr, const cv::Mat& seen) {
  cv::Mat a, b;
  cv::cvtColor(a_bgr, a, cv::COLOR_BGR2GRAY);
  cv::cvtColor(b_bgr, b, cv::COLOR_BGR2GRAY);
  double all = 0;
  for (int i = -5; i <= 5; ++i)
    for (int j = -5; j <= 5; ++j) all += std::exp(-(i * i + j * j) / 4.5);
  double sum = 0;
  int count = 0;
  for (int y = 0; y < a.rows; ++y)
    for (int x = 0; x < a.cols; ++x) {
      if (!seen.at<uchar>(y, x)) continue;
      double w = 0, ma = 0, mb = 0, aa = 0, bb = 0, ab = 0;
      for (int i = std::max(0, y - 5); i <= std::min(a.rows - 1, y + 5); ++i)
        for (int j = std::max(0, x - 5); j <= std::min(a.cols - 1, x + 5); ++j) {
          if (!seen.at<uchar>(i, j)) continue;
          const double g = std::exp(-((i - y) * (i - y) + (j - x) * (j - x)) / 4.5) / all;
          const double u = a.at<uchar>(i, j), v = b.at<uchar>(i, j);
          w += g, ma += g * u, mb += g * v, aa += g * u * u, bb += g * v * v, ab += g * u * v;
        }
      if (w < 0.5) continue;
      ma /= w, mb /= w;
      const double va = aa / w - ma * ma, vb = bb / w - mb * mb, cov = ab / w - ma * mb;
      const double c1 = 2.55 * 2.55, c2 = 7.65 * 7.65;
      sum += (2 * ma * mb + c1) * (2 * cov + c2) / ((ma * ma + mb * mb + c1) * (va + vb + c2));
      ++count;
    }
  return sum / count;
}

TEST(ImageComparison, PsnrOfAKnownDifference) {
  const cv::Mat actual(40, 60, CV_8UC3, cv::Scalar(100, 100, 100));
  const ImageComparison comparison(actual, all_seen(actual));
  // One channel off by 30: MSE 300, 10 log10(65025 / 300).
  EXPECT_NEAR(*comparison.psnr_db(cv::Mat(40, 60, CV_8UC3, cv::Scalar(100, 130, 100))), 23.3596, 1e-3);
  // All three off by 10: MSE 100.
  EXPECT_NEAR(*comparison.psnr_db(cv::Mat(40, 60, CV_8UC4, cv::Scalar(90, 110, 90, 7))), 28.1308, 1e-3);
  EXPECT_EQ(*comparison.psnr_db(actual), ImageComparison::kMaxPsnr);
}

TEST(ImageComparison, EqualPicturesScoreOne) {
  const cv::Mat actual = textured(97, 71, 1);
  const ImageQuality quality = ImageComparison(actual, all_seen(actual)).measure(actual);
  EXPECT_NEAR(*quality.ssim, 1, 1e-6);
  EXPECT_EQ(*quality.sharpness, 1);
}

TEST(ImageComparison, SsimAgreesWithBruteForce) {
  const cv::Mat actual = textured(90, 141, 2);
  cv::Mat shown = textured(90, 141, 3);
  cv::addWeighted(actual, 0.7, shown, 0.3, 5, shown);
  cv::Mat seen = all_seen(actual);
  EXPECT_NEAR(*ImageComparison(actual, seen).ssim(shown), reference_ssim(actual, shown, seen), 1e-4);
  cv::circle(seen, {40, 70}, 25, 0, cv::FILLED);
  seen.row(64) = 0;  // across the border of two strips
  EXPECT_NEAR(*ImageComparison(actual, seen).ssim(shown), reference_ssim(actual, shown, seen), 1e-4);
}

TEST(ImageComparison, UnseenPixelsDoNotCount) {
  const cv::Mat actual = textured(80, 60, 4);
  cv::Mat seen = all_seen(actual), shown = actual.clone();
  const cv::Rect hole(20, 20, 30, 15);
  seen(hole) = 0;
  shown(hole).setTo(cv::Scalar(0, 255, 0));
  const ImageQuality quality = ImageComparison(actual, seen).measure(shown);
  EXPECT_EQ(*quality.psnr_db, ImageComparison::kMaxPsnr);
  EXPECT_NEAR(*quality.ssim, 1, 1e-6);
  EXPECT_EQ(*quality.sharpness, 1);
}

TEST(ImageComparison, BlurIsLessSharpAndNoiseMore) {
  const cv::Mat actual = textured(120, 90, 5);
  const ImageComparison comparison(actual, all_seen(actual));
  cv::Mat blurred, noise(actual.size(), CV_8UC3), noisy;
  cv::GaussianBlur(actual, blurred, {0, 0}, 2);
  cv::RNG(6).fill(noise, cv::RNG::UNIFORM, 0, 40);
  cv::add(actual, noise, noisy);
  EXPECT_LT(*comparison.sharpness(blurred), 0.8);
  EXPECT_GT(*comparison.sharpness(noisy), 1.05);
}

TEST(ImageComparison, NothingSeenIsNothingMeasured) {
  const cv::Mat actual = textured(32, 24, 7);
  const ImageQuality none = ImageComparison(actual, cv::Mat::zeros(24, 32, CV_8U)).measure(actual);
  EXPECT_FALSE(none.psnr_db || none.ssim || none.sharpness);
  cv::Mat one = cv::Mat::zeros(24, 32, CV_8U);
  one.at<uchar>(12, 12) = 255;
  const ImageQuality lonely = ImageComparison(actual, one).measure(actual);
  EXPECT_TRUE(lonely.psnr_db);
  EXPECT_FALSE(lonely.ssim || lonely.sharpness);
  const cv::Mat flat(24, 32, CV_8UC3, cv::Scalar(9, 9, 9));
  EXPECT_FALSE(ImageComparison(flat, all_seen(flat)).sharpness(actual));
}

TEST(ImageComparison, RefusesOtherTypesAndSizes) {
  const cv::Mat actual = textured(32, 24, 8);
  EXPECT_THROW(ImageComparison(actual, cv::Mat::zeros(24, 31, CV_8U)), std::invalid_argument);
  EXPECT_THROW(ImageComparison(cv::Mat::zeros(24, 32, CV_8U), all_seen(actual)), std::invalid_argument);
  EXPECT_THROW(ImageComparison(actual, all_seen(actual)).measure(textured(31, 24, 8)), std::invalid_argument);
  EXPECT_THROW(ImageComparison(actual, all_seen(actual)).psnr_db(cv::Mat()), std::invalid_argument);
}

TEST(Coverage, IsReadFromAlpha) {
  cv::Mat predicted(10, 10, CV_8UC4, cv::Scalar(1, 2, 3, 255));
  predicted.rowRange(0, 1).setTo(cv::Scalar(0, 0, 0, 0));
  predicted.rowRange(1, 3).setTo(cv::Scalar(0, 0, 0, 64));
  predicted.rowRange(3, 6).setTo(cv::Scalar(0, 0, 0, 128));
  const Coverage coverage = measure_coverage(predicted);
  EXPECT_DOUBLE_EQ(coverage.seen, 0.4);
  EXPECT_DOUBLE_EQ(coverage.filled, 0.3);
  EXPECT_DOUBLE_EQ(coverage.uncoloured, 0.2);
  EXPECT_DOUBLE_EQ(coverage.no_model, 0.1);
  EXPECT_NEAR(*coverage.coloured_of_model(), 7.0 / 9, 1e-12);
  EXPECT_EQ(cv::countNonZero(seen_mask(predicted)), 40);
  EXPECT_FALSE(measure_coverage(cv::Mat::zeros(4, 4, CV_8UC4)).coloured_of_model());
  EXPECT_THROW(measure_coverage(cv::Mat::zeros(4, 4, CV_8UC3)), std::invalid_argument);
}

}  // namespace
}  // namespace foresight::image_metrics_test

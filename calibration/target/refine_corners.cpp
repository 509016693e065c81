#include "calibration/target/refine_corners.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <vector>

#include "common/statistics.hpp"

namespace foresight {
namespace {

constexpr double kLeastNoise = 0.03;  // px: what is left of interpolation, however good the image
constexpr double kMostNoise = 10;

}  // namespace

int refinement_half_window(float spacing, double share) {
  return std::clamp(static_cast<int>(share * spacing), 2, 11);
}

cv::Point2f refine_corner(const cv::Mat& grey, cv::Point2f start, int half_window) {
  std::vector<cv::Point2f> corner{start};
  cv::cornerSubPix(grey, corner, {half_window, half_window}, {-1, -1},
                   {cv::TermCriteria::COUNT + cv::TermCriteria::EPS, 100, 1e-4});
  return corner[0];
}

double corner_noise(const cv::Mat& grey, cv::Point2f corner, int half_window) {
  const int h = half_window, side = 2 * h + 1;
  cv::Mat patch;
  cv::getRectSubPix(grey, {side + 2, side + 2}, corner, patch, CV_32F);
  Eigen::Matrix2d A = Eigen::Matrix2d::Zero(), middle = Eigen::Matrix2d::Zero();
  for (int y = -h; y <= h; ++y) {
    const float* above = patch.ptr<float>(y + h);
    const float* here = patch.ptr<float>(y + h + 1);
    const float* below = patch.ptr<float>(y + h + 2);
    for (int x = -h; x <= h; ++x) {
      const int c = x + h + 1;
      const Eigen::Vector2d g(here[c + 1] - here[c - 1], below[c] - above[c]);
      const double w = std::exp(-static_cast<double>(x * x + y * y) / (h * h));
      const double e = g.x() * x + g.y() * y;
      A += w * g * g.transpose();
      middle += w * w * e * e * g * g.transpose();
    }
  }
  if (!(A.determinant() > 1e-6 * A.trace() * A.trace())) return kMostNoise;
  const Eigen::Matrix2d inverse = A.inverse();
  return std::clamp(std::sqrt((inverse * middle * inverse).trace() / 2), kLeastNoise, kMostNoise);
}

double disc_noise(const cv::Mat& grey, cv::Point2f centre, double radius, double noise) {
  double steepest = 0;
  constexpr int kRays = 16;
  for (int ray = 0; ray < kRays; ++ray) {
    const double angle = 2 * CV_PI * ray / kRays;
    const cv::Point2f rim = centre + cv::Point2f(static_cast<float>(radius * std::cos(angle)),
                                                 static_cast<float>(radius * std::sin(angle)));
    cv::Mat patch;
    cv::getRectSubPix(grey, {3, 3}, rim, patch, CV_32F);
    steepest +=
        std::hypot(patch.at<float>(1, 2) - patch.at<float>(1, 0), patch.at<float>(2, 1) - patch.at<float>(0, 1)) /
        (2 * kRays);
  }
  const double along_rim = std::max(4.0, 2 * CV_PI * radius);
  const double sigma = noise / std::max(steepest, 1e-3) * std::sqrt(2 / along_rim);
  return std::clamp(std::hypot(kLeastNoise, sigma), kLeastNoise, kMostNoise);
}

double pixel_noise(const cv::Mat& grey) {
  cv::Mat second;
  const cv::Matx33f difference(1, -2, 1, -2, 4, -2, 1, -2, 1);
  cv::filter2D(grey, second, CV_32F, difference);
  std::vector<float> sizes;
  sizes.reserve(second.total() / 4 + 1);
  for (int y = 1; y < second.rows - 1; y += 2)
    for (int x = 1; x < second.cols - 1; x += 2) sizes.push_back(std::abs(second.at<float>(y, x)));
  return median(std::move(sizes)) / 0.6745 / 6;  // the filter's norm is 6
}

}  // namespace foresight

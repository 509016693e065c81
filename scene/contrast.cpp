#include "scene/contrast.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <opencv2/imgproc.hpp>

namespace foresight {
namespace {

constexpr double kFirstLevels = 3, kStepsADoubling = 4;

double least_levels(double step) {
  return kFirstLevels * (std::exp2(step / kStepsADoubling) - 1);
}

}  // namespace

double contrast_levels(int step) {
  return least_levels(step + 0.5);
}

cv::Mat contrast_steps(const cv::Mat& grey) {
  // With g the pixel and n the nine around and at it: sum of (n - g)^2 = sum of n^2 - 2 g sum of n + 9 g^2.
  cv::Mat here, sum, squares, around;
  grey.convertTo(here, CV_32F);
  cv::boxFilter(here, sum, CV_32F, {3, 3}, {-1, -1}, false, cv::BORDER_REPLICATE);
  cv::sqrBoxFilter(here, squares, CV_32F, {3, 3}, {-1, -1}, false, cv::BORDER_REPLICATE);
  around = squares - here.mul(2 * sum - 9 * here);

  cv::Mat out = cv::Mat::zeros(grey.size(), CV_8UC1), above;
  for (int step = 1; step < kContrastSteps; ++step) {
    const double least = least_levels(step);
    cv::compare(around, 8 * least * least, above, cv::CMP_GE);
    cv::add(out, 1, out, above);
  }
  return out;
}

}  // namespace foresight

#include "display/stereogram/decode.hpp"

#include <cmath>
#include <opencv2/imgproc.hpp>

namespace foresight {
namespace {

const cv::Size kWindow(11, 7);

/// For each pixel, how much its surroundings differ from those `shift` px to its left; large where that is outside.
cv::Mat difference_at(const cv::Mat& picture, int shift) {
  cv::Mat out(picture.size(), CV_32F, cv::Scalar(1e6));
  const int width = picture.cols - shift;
  if (width <= 0) return out;
  cv::Mat difference, grey, mean;
  cv::absdiff(picture.colRange(shift, picture.cols), picture.colRange(0, width), difference);
  cv::transform(difference, grey, cv::Matx13f(1, 1, 1));
  grey.convertTo(grey, CV_32F);
  cv::boxFilter(grey, mean, CV_32F, kWindow);
  mean.copyTo(out.colRange(shift, picture.cols));
  return out;
}

/// Where a parabola through three values at -1, 0, 1 has its least.
double vertex(double before, double here, double after) {
  const double bend = before - 2 * here + after;
  return bend > 0 ? std::clamp(0.5 * (before - after) / bend, -0.5, 0.5) : 0;
}

}  // namespace

cv::Mat decode_stereogram(const cv::Mat& picture, double least, double most) {
  const int first = static_cast<int>(std::floor(least)) - 1, last = static_cast<int>(std::ceil(most)) + 1;
  std::vector<cv::Mat> all;
  for (int shift = first; shift <= last; ++shift) all.push_back(difference_at(picture, shift));
  cv::Mat out(picture.size(), CV_32F, cv::Scalar(0));
  for (int y = 0; y < picture.rows; ++y)
    for (int x = last; x < picture.cols; ++x) {
      std::size_t best = 1;
      for (std::size_t i = 1; i + 1 < all.size(); ++i)
        if (all[i].at<float>(y, x) < all[best].at<float>(y, x)) best = i;
      const double part =
          vertex(all[best - 1].at<float>(y, x), all[best].at<float>(y, x), all[best + 1].at<float>(y, x));
      out.at<float>(y, x) = static_cast<float>(first + static_cast<double>(best) + part);
    }
  return out;
}

double share_decoded(const cv::Mat& nearness, const cv::Mat& decoded, const StereogramDepth& depth, double tolerance) {
  std::size_t points = 0, right = 0;
  for (int y = 0; y < nearness.rows; ++y)
    for (int x = 0; x < nearness.cols; ++x) {
      const double s = depth.separation(nearness.at<float>(y, x));
      // Where the right eye sees it, if nothing nearer is there.
      const int at = static_cast<int>(std::lround(x + 0.5 * s));
      if (at >= nearness.cols || decoded.at<float>(y, at) == 0) continue;
      ++points;
      right += std::abs(decoded.at<float>(y, at) - s) <= tolerance ? 1 : 0;
    }
  return points == 0 ? 0 : static_cast<double>(right) / static_cast<double>(points);
}

}  // namespace foresight

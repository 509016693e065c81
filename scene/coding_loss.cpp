#include "scene/coding_loss.hpp"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

namespace foresight {
namespace {

cv::Mat grey_of(const cv::Mat& picture) {
  if (picture.channels() == 1) return picture;
  cv::Mat out;
  cv::cvtColor(picture, out, picture.channels() == 4 ? cv::COLOR_BGRA2GRAY : cv::COLOR_BGR2GRAY);
  return out;
}

int step_of(double share) {
  if (share < kLeastLoss) return 0;
  return std::min(1 + static_cast<int>(std::log2(share / kLeastLoss)), kLossSteps - 1);
}

}  // namespace

double share_lost(int step) {
  return kLeastLoss * std::exp2(step - 0.5);
}

cv::Mat grey_difference(const cv::Mat& one, const cv::Mat& other) {
  cv::Mat out;
  cv::absdiff(grey_of(one), grey_of(other), out);
  return out;
}

cv::Mat coding_loss(const cv::Mat& taken, const cv::Mat& came) {
  cv::Mat shares, out(kLossRows, kLossColumns, CV_8UC1);
  cv::resize(grey_difference(taken, came) > kLossLevels, shares, out.size(), 0, 0, cv::INTER_AREA);
  for (int y = 0; y < out.rows; ++y)
    for (int x = 0; x < out.cols; ++x)
      out.at<uchar>(y, x) = static_cast<uchar>(step_of(shares.at<uchar>(y, x) / 255.0));
  return out;
}

std::optional<cv::Mat> loss_of(std::span<const std::uint8_t> steps) {
  if (steps.empty()) return cv::Mat();
  if (steps.size() != kLossRows * kLossColumns ||
      std::ranges::any_of(steps, [](int step) { return step >= kLossSteps; }))
    return std::nullopt;
  cv::Mat out(kLossRows, kLossColumns, CV_8UC1);
  std::ranges::copy(steps, out.begin<std::uint8_t>());
  return out;
}

cv::Mat kept_mask(const cv::Mat& loss, cv::Size size) {
  cv::Mat out(size, CV_8UC1, cv::Scalar(255));
  if (!loss.empty()) cv::resize(loss == 0, out, size, 0, 0, cv::INTER_NEAREST);
  return out;
}

}  // namespace foresight

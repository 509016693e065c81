#include "texture_gpu/colour_balance.hpp"

#include <algorithm>
#include <cmath>

#include "texture_gpu/white_balance.hpp"

namespace foresight {
namespace {

constexpr double kDiffers = 0.03, kAlike = 0.02;  // logarithms: from the one on images are corrected, to the other
constexpr double kLargest = 1.5;                  // a factor of 4.5
constexpr double kLearns = 0.3;                   // at least that share of what is left an image corrects

}  // namespace

std::optional<Eigen::Vector2d> ColourBalance::factors() const {
  if (!differs_) return std::nullopt;
  return Eigen::Vector2d((-log_).array().exp());
}

cv::Mat ColourBalance::apply(const cv::Mat& right) {
  applied_ = differs_ && right.type() == CV_8UC3 ? log_ : Eigen::Vector2d::Zero();
  return applied_.isZero(0) ? right : balanced(right, applied_);
}

bool ColourBalance::learn(std::span<const ExposureSample> samples, std::span<AtlasPage* const> pages) {
  const auto left = hue_difference(samples, pages);
  if (!left) return false;
  const Eigen::Vector2d seen = applied_ + left->log;
  log_ += std::max(kLearns, 1.0 / ++learnt_) * (seen - log_);
  log_ = log_.cwiseMax(-kLargest).cwiseMin(kLargest);
  differs_ = log_.cwiseAbs().maxCoeff() > (differs_ ? kAlike : kDiffers);
  return differs_ && (log_ - applied_).cwiseAbs().maxCoeff() > kDiffers;
}

}  // namespace foresight

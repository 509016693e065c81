#include "texture_gpu/colour_balance.hpp"

#include <algorithm>
#include <cmath>

#include "common/statistics.hpp"

namespace foresight {
namespace {

constexpr std::size_t kFewestPages = 30;
constexpr double kDiffers = 0.03, kAlike = 0.02;  // logarithms: from the one on images are corrected, to the other
constexpr double kLargest = 1.5;                  // a factor of 4.5
constexpr double kLearns = 0.3;                   // at least that share of what is left an image corrects
constexpr float kTooDark = 0.04f;                 // below, black level and noise rule
constexpr int kWhite = 250;                       // in all three channels: it stays white

bool can_tell(const ExposureSample& sample) {
  return sample.brightness > kTooDark && !sample.white();
}

}  // namespace

std::optional<Eigen::Vector2d> ColourBalance::factors() const {
  if (!differs_) return std::nullopt;
  return Eigen::Vector2d((-log_).array().exp());
}

cv::Mat ColourBalance::apply(const cv::Mat& right) {
  const auto factor = right.type() == CV_8UC3 ? factors() : std::nullopt;
  applied_ = factor ? log_ : Eigen::Vector2d::Zero();
  if (!factor) return right;
  cv::Mat table(1, 256, CV_8UC3);
  for (int value = 0; value < 256; ++value) {
    const auto times = [&](double by) { return cv::saturate_cast<uchar>(value * by); };
    table.at<cv::Vec3b>(value) = {times(factor->y()), static_cast<uchar>(value), times(factor->x())};
  }
  cv::Mat out, white;
  cv::LUT(right, table, out);
  cv::inRange(right, cv::Scalar::all(kWhite), cv::Scalar::all(255), white);
  out.setTo(cv::Scalar::all(255), white);
  return out;
}

void ColourBalance::remember(std::span<const ExposureSample> samples, std::span<AtlasPage* const> pages) {
  for (std::size_t i = 0; i < samples.size(); ++i)
    if (pages[i] && can_tell(samples[i])) pages[i]->exposure.hue = {samples[i].log_red, samples[i].log_blue};
}

bool ColourBalance::learn(std::span<const ExposureSample> samples, std::span<AtlasPage* const> pages) {
  std::vector<double> red, blue;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    if (!pages[i] || !can_tell(samples[i]) || std::isnan(pages[i]->exposure.hue[0])) continue;
    red.push_back(samples[i].log_red - pages[i]->exposure.hue[0]);
    blue.push_back(samples[i].log_blue - pages[i]->exposure.hue[1]);
  }
  if (red.size() < kFewestPages) return false;
  const Eigen::Vector2d seen = applied_ + Eigen::Vector2d(median(red), median(blue));
  log_ += std::max(kLearns, 1.0 / ++learnt_) * (seen - log_);
  log_ = log_.cwiseMax(-kLargest).cwiseMin(kLargest);
  differs_ = log_.cwiseAbs().maxCoeff() > (differs_ ? kAlike : kDiffers);
  return differs_ && (log_ - applied_).cwiseAbs().maxCoeff() > kDiffers;
}

}  // namespace foresight

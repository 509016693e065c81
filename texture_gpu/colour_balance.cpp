#include "texture_gpu/colour_balance.hpp"

#include <algorithm>
#include <cmath>

#include "common/statistics.hpp"

namespace foresight {
namespace {

constexpr std::size_t kFewestPages = 30;
constexpr double kDiffers = 0.03, kAlike = 0.02;  // logarithms: from the one on images are corrected, to the other
constexpr double kClearly = 0.15;                 // of whole images, whose borders show other things: more is believed
constexpr double kLargest = 1.5;                  // a factor of 4.5
constexpr double kLearns = 0.3;                   // share of what is left that an image corrects
constexpr float kTooDark = 0.04f;                 // below, black level and noise rule
constexpr int kWhite = 250;                       // in all three channels: it stays white
constexpr double kLeastValue = 0.5;               // of 255

bool can_tell(const ExposureSample& sample) {
  return sample.brightness > kTooDark && !sample.white();
}

Eigen::Vector2d hue_of(const cv::Mat& image) {
  const cv::Scalar mean = cv::mean(image);
  const auto log_of = [&](int channel) { return std::log(std::max(mean[channel], kLeastValue)); };
  return {log_of(2) - log_of(1), log_of(0) - log_of(1)};
}

Eigen::Vector2d limited(const Eigen::Vector2d& log) {
  return log.cwiseMax(-kLargest).cwiseMin(kLargest);
}

}  // namespace

std::optional<Eigen::Vector2d> ColourBalance::factors() const {
  if (!differs_) return std::nullopt;
  return Eigen::Vector2d((-*log_).array().exp());
}

void ColourBalance::note_whether_alike() {
  differs_ = log_->cwiseAbs().maxCoeff() > (differs_ ? kAlike : kDiffers);
}

cv::Mat ColourBalance::apply(const cv::Mat& left, const cv::Mat& right) {
  applied_ = false;
  if (left.type() != CV_8UC3 || right.type() != CV_8UC3) return right;
  if (!log_) {
    const Eigen::Vector2d log = limited(hue_of(right) - hue_of(left));
    log_ = log.cwiseAbs().maxCoeff() > kClearly ? log : Eigen::Vector2d::Zero();
    note_whether_alike();
  }
  const auto factor = factors();
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
  applied_ = true;
  return out;
}

void ColourBalance::remember(std::span<const ExposureSample> samples, std::span<AtlasPage* const> pages) {
  for (std::size_t i = 0; i < samples.size(); ++i)
    if (pages[i] && can_tell(samples[i])) pages[i]->exposure.hue = {samples[i].log_red, samples[i].log_blue};
}

void ColourBalance::learn(std::span<const ExposureSample> samples, std::span<AtlasPage* const> pages) {
  std::vector<double> red, blue;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    if (!pages[i] || !can_tell(samples[i]) || std::isnan(pages[i]->exposure.hue[0])) continue;
    red.push_back(samples[i].log_red - pages[i]->exposure.hue[0]);
    blue.push_back(samples[i].log_blue - pages[i]->exposure.hue[1]);
  }
  if (red.size() < kFewestPages || !log_) return;
  // Of an image that was not corrected all of it is left, and no more than that.
  const Eigen::Vector2d left(median(red), median(blue));
  log_ =
      limited(applied_ ? Eigen::Vector2d(*log_ + kLearns * left) : Eigen::Vector2d(*log_ + kLearns * (left - *log_)));
  note_whether_alike();
}

}  // namespace foresight

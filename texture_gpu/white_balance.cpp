#include "texture_gpu/white_balance.hpp"

#include <algorithm>
#include <cmath>

#include "common/statistics.hpp"

namespace foresight {
namespace {

constexpr std::size_t kFewestPages = 30;
constexpr float kTooDark = 0.04f;        // below, black level and noise rule
constexpr int kWhite = 250;              // in all three channels: it stays white
constexpr double kLargest = 1.5;         // a factor of 4.5
constexpr double kLeast = 0.004;         // a grey level of 250
constexpr double kSigmas = 2;            // from so many on a difference counts,
constexpr double kStays = 0.5;           // and goes on to from this share of both bounds on
constexpr double kAnew = 0.008;          // two grey levels: that image is corrected again
constexpr double kIndependent = 0.1;     // share of the pages: neighbours have the same errors
constexpr double kSameSurface = 0.2;     // a page's hue changes by more
constexpr int kMostImages = 100;         // that a page's hue is the mean of
constexpr double kSigmaOfMedian = 1.25;  // of normal values, times that of their mean

bool can_tell(const ExposureSample& sample) {
  return sample.brightness > kTooDark && !sample.white();
}

/// The mean over images: replaced by each, the hues of all pages would walk away together. What looks otherwise once
/// may be a reflection; what goes on to is something else that lies there now.
void remember(PageExposure& page, const Eigen::Vector2d& hue) {
  const Eigen::Vector2d before(page.hue[0], page.hue[1]);
  const bool same = (hue - before).cwiseAbs().maxCoeff() < kSameSurface;
  if (page.rough) page.hue_count = 0;
  if (page.hue_count > 0 && !same && (page.hue_count /= 2) > 0) return;
  page.hue_count = std::min(page.hue_count + 1, kMostImages);
  const Eigen::Vector2d mean = page.hue_count > 1 ? before + (hue - before) / page.hue_count : hue;
  page.hue = {static_cast<float>(mean.x()), static_cast<float>(mean.y())};
}

}  // namespace

std::optional<HueDifference> hue_difference(std::span<const ExposureSample> samples,
                                            std::span<AtlasPage* const> pages) {
  std::vector<double> differences[2];
  for (std::size_t i = 0; i < samples.size(); ++i) {
    if (!pages[i] || !can_tell(samples[i]) || pages[i]->exposure.hue_count == 0) continue;
    differences[0].push_back(samples[i].log_red - pages[i]->exposure.hue[0]);
    differences[1].push_back(samples[i].log_blue - pages[i]->exposure.hue[1]);
  }
  if (differences[0].size() < kFewestPages) return std::nullopt;
  HueDifference out;
  for (int k = 0; k < 2; ++k) {
    out.log[k] = median(differences[k]);
    for (double& difference : differences[k]) difference -= out.log[k];
    const double independent = kIndependent * static_cast<double>(differences[k].size());
    out.sigma[k] = kSigmaOfMedian * robust_sigma(differences[k]) / std::sqrt(independent);
  }
  return out;
}

cv::Mat balanced(const cv::Mat& image, const Eigen::Vector2d& log) {
  if (image.type() != CV_8UC3) return image;
  const double red = std::exp(-log.x()), blue = std::exp(-log.y());
  cv::Mat table(1, 256, CV_8UC3);
  for (int value = 0; value < 256; ++value)
    table.at<cv::Vec3b>(value) = {cv::saturate_cast<uchar>(value * blue), static_cast<uchar>(value),
                                  cv::saturate_cast<uchar>(value * red)};
  cv::Mat out, white;
  cv::LUT(image, table, out);
  cv::inRange(image, cv::Scalar::all(kWhite), cv::Scalar::all(255), white);
  out.setTo(cv::Scalar::all(255), white);
  return out;
}

cv::Mat WhiteBalance::apply(const cv::Mat& image) {
  applied_ = image.type() == CV_8UC3 ? log_ : Eigen::Vector2d::Zero();
  return applied_.isZero(0) ? image : balanced(image, applied_);
}

bool WhiteBalance::learn(std::span<const ExposureSample> samples, std::span<AtlasPage* const> pages) {
  Eigen::Vector2d seen = log_;
  if (const auto left = hue_difference(samples, pages)) {
    seen = (applied_ + left->log).cwiseMax(-kLargest).cwiseMin(kLargest);
    const Eigen::Vector2d least = (kSigmas * left->sigma).cwiseMax(kLeast) * (log_.isZero(0) ? 1 : kStays);
    const bool counts = (seen.cwiseAbs() - least).maxCoeff() > 0;
    log_ = counts ? seen : Eigen::Vector2d::Zero();
  }
  // Less what was seen, whether it counts or not: what changes slowly would else become part of what is remembered.
  for (std::size_t i = 0; i < samples.size(); ++i)
    if (pages[i] && can_tell(samples[i]))
      remember(pages[i]->exposure, Eigen::Vector2d(samples[i].log_red, samples[i].log_blue) + applied_ - seen);
  return (log_ - applied_).cwiseAbs().maxCoeff() > kAnew;
}

}  // namespace foresight

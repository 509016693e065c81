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

constexpr double kMemory = 0.9;   // weight of the images before against the one that is counted
constexpr double kAssumed = 200;  // pixels of each kind that are taken to have been as lost as their tile

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

LossShares even_loss_shares() {
  LossShares out;
  for (int step = 1; step <= kToldSteps; ++step) out[static_cast<std::size_t>(step - 1)].fill(share_lost(step));
  return out;
}

void LossCount::add(const cv::Mat& taken, const cv::Mat& came, const cv::Mat& steps) {
  for (auto& contrasts : of_late_)
    for (Pixels& pixels : contrasts) pixels = {kMemory * pixels.all, kMemory * pixels.lost};
  if (cv::countNonZero(steps) == 0) return;
  const cv::Mat grey = grey_of(came), contrast = contrast_steps(grey),
                lost = grey_difference(taken, grey) > kLossLevels;
  cv::Mat step;
  cv::resize(steps, step, came.size(), 0, 0, cv::INTER_NEAREST);
  for (int y = 0; y < step.rows; ++y)
    for (int x = 0; x < step.cols; ++x) {
      const int of = step.at<uchar>(y, x);
      if (of < 1 || of > kToldSteps) continue;
      Pixels& pixels =
          of_late_[static_cast<std::size_t>(of - 1)][static_cast<std::size_t>(loss_contrast(contrast.at<uchar>(y, x)))];
      pixels.all += 1;
      pixels.lost += lost.at<uchar>(y, x) ? 1 : 0;
    }
}

LossShares LossCount::shares() const {
  LossShares out = even_loss_shares();
  for (std::size_t i = 0; i < out.size(); ++i)
    for (std::size_t k = 0; k < out[i].size(); ++k)
      out[i][k] = (of_late_[i][k].lost + kAssumed * out[i][k]) / (of_late_[i][k].all + kAssumed);
  return out;
}

// As roots: a byte then tells small shares finely enough.
std::vector<std::uint8_t> to_bytes(const LossShares& shares) {
  std::vector<std::uint8_t> out;
  for (const auto& contrasts : shares)
    for (const double share : contrasts)
      out.push_back(static_cast<std::uint8_t>(std::lround(255 * std::sqrt(std::clamp(share, 0.0, 1.0)))));
  return out;
}

std::optional<LossShares> loss_shares_of(std::span<const std::uint8_t> bytes) {
  if (bytes.empty()) return even_loss_shares();
  if (bytes.size() != kToldSteps * kLossContrasts) return std::nullopt;
  LossShares out;
  for (std::size_t i = 0; i < bytes.size(); ++i)
    out[i / kLossContrasts][i % kLossContrasts] = (bytes[i] / 255.0) * (bytes[i] / 255.0);
  return out;
}

cv::Mat kept_mask(const cv::Mat& loss, cv::Size size) {
  cv::Mat out(size, CV_8UC1, cv::Scalar(255));
  if (!loss.empty()) cv::resize(loss == 0, out, size, 0, 0, cv::INTER_NEAREST);
  return out;
}

}  // namespace foresight

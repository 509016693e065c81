#include "seat/shown_fidelity.hpp"

#include <algorithm>
#include <opencv2/imgproc.hpp>

#include "apps/replay_report/image_metrics.hpp"
#include "display/trust_pass.hpp"

namespace foresight {
namespace {

constexpr double kFirstLimit = 10;       // before anything was compared: as many grey levels as count as wrong
constexpr double kMemory = 0.8;          // weight of what was compared before against what is compared now
constexpr double kPatch = 0.6;           // share of a neighbourhood that is wrong where more than an outline is
constexpr int kPatchPx[] = {5, 11, 21};  // sides of neighbourhoods

/// What is wrong as a patch, not as the outline of what is shown a pixel aside, and room around it: over the next delay
/// what moves unforetold goes on by about as much as it did over the last, which is how wide a patch it left.
cv::Mat patches_of(const cv::Mat& wrong) {
  cv::Mat share, patch, out = cv::Mat::zeros(wrong.size(), CV_8UC1);
  for (const int side : kPatchPx) {
    cv::boxFilter(wrong, share, CV_8U, {side, side});
    cv::threshold(share, patch, 255 * kPatch, 255, cv::THRESH_BINARY);
    cv::dilate(patch, patch, cv::getStructuringElement(cv::MORPH_ELLIPSE, {2 * side + 1, 2 * side + 1}));
    out |= patch;
  }
  return out;
}

double share_of(const cv::Mat& part, const cv::Mat& whole) {
  return cv::countNonZero(part & whole) / std::max(1.0, static_cast<double>(cv::countNonZero(whole)));
}

cv::Mat grey_of(const cv::Mat& picture) {
  cv::Mat out;
  cv::cvtColor(picture, out, picture.channels() == 4 ? cv::COLOR_BGRA2GRAY : cv::COLOR_BGR2GRAY);
  return out;
}

}  // namespace

cv::Rect tile_of(std::size_t tile, cv::Size size) {
  const auto edge = [](std::size_t i, std::size_t count, int length) {
    return static_cast<int>(i * static_cast<std::size_t>(length) / count);
  };
  const std::size_t x = tile % Fidelity::kColumns, y = tile / Fidelity::kColumns;
  const int left = edge(x, Fidelity::kColumns, size.width), top = edge(y, Fidelity::kRows, size.height);
  return {left, top, edge(x + 1, Fidelity::kColumns, size.width) - left,
          edge(y + 1, Fidelity::kRows, size.height) - top};
}

std::string place_of(std::size_t tile) {
  const std::size_t column = 3 * (tile % Fidelity::kColumns) / Fidelity::kColumns,
                    row = 3 * (tile / Fidelity::kColumns) / Fidelity::kRows;
  static constexpr const char* kNames[3][3] = {
      {"top left", "top", "top right"}, {"left", "middle", "right"}, {"bottom left", "bottom", "bottom right"}};
  return kNames[std::min<std::size_t>(row, 2)][column];
}

cv::Mat exact_mask(const cv::Mat& picture, const cv::Mat& doubt, double limit) {
  return seen_mask(picture) & (doubt <= std::min(limit, kUnconfirmed - 1.0));
}

cv::Mat grey_difference(const cv::Mat& one, const cv::Mat& other) {
  cv::Mat out;
  cv::absdiff(grey_of(one), grey_of(other), out);
  return out;
}

ShownFidelity::ShownFidelity(FidelityOptions options) : options_(options), limit_(kFirstLimit) {}

void ShownFidelity::shown(RememberedView picture) {
  if (!kept_.empty() && picture.instant <= kept_.back().instant) kept_.clear();  // another clock
  kept_.push_back(std::move(picture));
  if (kept_.size() > options_.kept) kept_.pop_front();
}

std::optional<Fidelity> ShownFidelity::arrived(RobotTime instant, const cv::Mat& image) {
  while (!kept_.empty() && kept_.front().instant < instant - options_.same_instant) kept_.pop_front();
  if (kept_.empty()) return std::nullopt;
  auto nearest = kept_.begin();
  const auto apart = [&](const RememberedView& p) { return std::max(p.instant - instant, instant - p.instant); };
  while (std::next(nearest) != kept_.end() && apart(*std::next(nearest)) < apart(*nearest)) ++nearest;
  if (apart(*nearest) > options_.same_instant) return std::nullopt;
  const RememberedView picture = std::move(*nearest);
  kept_.erase(kept_.begin(), std::next(nearest));
  if (picture.picture.size() != image.size() || image.type() != CV_8UC3) return std::nullopt;

  const cv::Mat seen = seen_mask(picture.picture), exact = exact_mask(picture.picture, picture.doubt, limit_);
  const cv::Mat wrong = (grey_difference(picture.picture, image) > options_.wrong_levels) & seen;
  const ImageComparison comparison(image, seen);
  Fidelity out{picture.instant, comparison.psnr_db(picture.picture), comparison.ssim(picture.picture), {}};
  for (std::size_t i = 0; i < out.wrong.size(); ++i) {
    const cv::Rect tile = tile_of(i, image.size());
    out.wrong[i] = tile.area() ? static_cast<double>(cv::countNonZero(wrong(tile))) / tile.area() : 0;
  }
  out.worst = static_cast<std::size_t>(std::ranges::max_element(out.wrong) - out.wrong.begin());
  out.exact_share = share_of(exact, seen);
  out.exact_wrong = share_of(wrong, exact);
  out.patches = patches_of(wrong);
  learn(seen, picture.doubt, wrong);
  return out;
}

void ShownFidelity::learn(const cv::Mat& seen, const cv::Mat& doubt, const cv::Mat& wrong) {
  for (Counts& counts : by_doubt_) counts.all *= kMemory, counts.wrong *= kMemory;
  for (int y = 0; y < seen.rows; ++y)
    for (int x = 0; x < seen.cols; ++x) {
      const std::size_t level = doubt.at<uchar>(y, x);
      if (!seen.at<uchar>(y, x) || level >= by_doubt_.size()) continue;
      by_doubt_[level].all += 1;
      by_doubt_[level].wrong += wrong.at<uchar>(y, x) ? 1 : 0;
    }
  Counts sum;
  double best = options_.least_limit;
  for (std::size_t level = 0; level < by_doubt_.size() && static_cast<double>(level) <= options_.most_limit; ++level) {
    sum.all += by_doubt_[level].all;
    sum.wrong += by_doubt_[level].wrong;
    if (sum.wrong <= options_.wrong_share * sum.all) best = std::max(best, static_cast<double>(level));
  }
  if (sum.all > 0) limit_ = best;
}

}  // namespace foresight

#include "seat/shown_fidelity.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <opencv2/imgproc.hpp>

#include "pictures/image_metrics.hpp"
#include "scene/coding_loss.hpp"

namespace foresight {
namespace {

constexpr double kMemory = 0.97;  // weight of what was compared before against what is compared now
constexpr double kAssumed =
    1.0 / 1024;  // of a picture's pixels: as many of each kind are taken to have been as assumed
// Before a kind has been seen: by how many px half of its pixels are aside, where a surface is just where it is thought
// to be, and the share that is wrong however flat; by how it was when last compared.
constexpr struct {
  double px, anyway;
} kAssumedOf[] = {{0.05, 0}, {0, 0}, {0.005, 0}, {0.025, 0}, {0.05, 0.04}, {0.1, 0.04}, {0.1, 0.08}};
constexpr double kOfReach = 0.03;        // of the px by which it may be elsewhere; half of the pixels are within
constexpr double kPatch = 0.6;           // share of a neighbourhood that is wrong where more than an outline is
constexpr int kPatchPx[] = {5, 11, 21};  // sides of neighbourhoods
// What comparing with images of a thin line does not tell: coding smooths them below what it is said to take away, and
// so what textures took of them. 0.3 to 0.6 % of what agrees with such an image, over four recorded lines.
constexpr double kSmoothed = 0.004;

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

/// What is said of each pixel when it is shown again. `off`: grey levels, 0 where the picture was not seen.
cv::Mat comparison_of(const cv::Mat& off, const cv::Mat& patches, const cv::Mat& seen) {
  cv::Mat out;
  cv::blur(off, out, {3, 3});
  out = cv::min(out, kMostLevelsOff);
  out.setTo(kInPatch, patches);
  out.setTo(kNotShown, ~seen);
  return out;
}

double share_of(const cv::Mat& part, const cv::Mat& whole) {
  return cv::countNonZero(part & whole) / std::max(1.0, static_cast<double>(cv::countNonZero(whole)));
}

bool is_coded_away(std::size_t doubt) {
  return doubt >= kCodedAway && doubt < kBesideEdge;
}

/// Before anything is known. Nearly all pixels are where they should be and a few far from there, as if they were
/// aside by a Cauchy distribution; grey changes by that times the contrast around.
double assumed_risk(std::size_t doubt, double wrong_levels) {
  const int number = static_cast<int>(doubt);
  const DoubtKind kind =
      number < kBesideEdge ? kind_of(number) : DoubtKind{2 * (number - kBesideEdge), 1, Compared::off};
  const auto& [px, anyway] = kAssumedOf[static_cast<std::size_t>(kind.compared)];
  const double half = kind.levels() * (px + kOfReach * kind.px());
  return anyway + (1 - anyway) * 2 / std::numbers::pi * std::atan(half / wrong_levels);
}

/// As large as the image, as it looks there; alpha and doubt as they are at the nearest pixel. False: they do not show
/// the same.
bool enlarge(RememberedView& view, cv::Size size) {
  cv::Mat& picture = view.picture;
  if (picture.size() == size) return true;
  const double wide = static_cast<double>(size.width) / picture.cols,
               high = static_cast<double>(size.height) / picture.rows;
  if (std::abs(size.height - picture.rows * wide) > wide + high) return false;  // other proportions
  cv::Mat alpha, large;
  cv::extractChannel(picture, alpha, 3);
  cv::resize(picture, large, size, 0, 0, cv::INTER_LINEAR);
  cv::resize(alpha, alpha, size, 0, 0, cv::INTER_NEAREST);
  cv::insertChannel(alpha, large, 3);
  picture = large;
  cv::resize(view.doubt, large, size, 0, 0, cv::INTER_NEAREST);
  view.doubt = large;
  return true;
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

cv::Mat exact_mask(const cv::Mat& picture, const cv::Mat& doubt, const ExactKinds& exact) {
  cv::Mat table(1, static_cast<int>(exact.size()), CV_8UC1), out;
  for (std::size_t kind = 0; kind < exact.size(); ++kind)
    table.at<uchar>(static_cast<int>(kind)) = exact[kind] && kind != kUnconfirmed ? 255 : 0;
  cv::LUT(doubt, table, out);
  return out & seen_mask(picture);
}

ShownFidelity::ShownFidelity(FidelityOptions options) : options_(options) {
  begin_anew({});
}

void ShownFidelity::begin_anew(RobotTime from) {
  begin_ = from;
  of_late_ = beside_patches_;
  learn();
  choose({});
}

void ShownFidelity::told(const LossShares& lost) {
  lost_ = lost;
  learn_coded_away();
}

void ShownFidelity::shown(RememberedView picture) {
  if (!kept_.empty() && picture.instant <= kept_.back().instant) {  // another clock
    kept_.clear();
    begin_ = {};
  }
  const cv::Mat seen = seen_mask(picture.picture);
  ByKind pixels = count(seen, picture.doubt, cv::Mat::zeros(seen.size(), CV_8UC1));
  for (std::size_t i = 0; i < pixels.size(); ++i) pixels[i].all += (1 - kMemory) * of_late_[i].all;
  choose(pixels);
  kept_.push_back(std::move(picture));
  if (kept_.size() > options_.kept) kept_.pop_front();
}

std::optional<Fidelity> ShownFidelity::arrived(RobotTime instant, const cv::Mat& image, const cv::Mat& lost,
                                               bool surprised) {
  while (!kept_.empty() && kept_.front().instant < instant - options_.same_instant) kept_.pop_front();
  if (kept_.empty()) return std::nullopt;
  auto nearest = kept_.begin();
  const auto apart = [&](const RememberedView& p) { return std::max(p.instant - instant, instant - p.instant); };
  while (std::next(nearest) != kept_.end() && apart(*std::next(nearest)) < apart(*nearest)) ++nearest;
  if (apart(*nearest) > options_.same_instant) return std::nullopt;
  RememberedView picture = std::move(*nearest);
  kept_.erase(kept_.begin(), std::next(nearest));
  if (image.type() != CV_8UC3 || !enlarge(picture, image.size())) return std::nullopt;

  smoothed_ = lost.empty() ? 0 : kSmoothed;
  const cv::Mat seen = seen_mask(picture.picture) & kept_mask(lost, image.size());
  const cv::Mat exact = exact_mask(picture.picture, picture.doubt, exact_) & seen;
  const cv::Mat off = grey_difference(picture.picture, image) & seen;
  const cv::Mat wrong = off > options_.wrong_levels;
  const ImageComparison comparison(image, seen);
  Fidelity out{picture.instant, comparison.psnr_db(picture.picture), comparison.ssim(picture.picture), {}};
  for (std::size_t i = 0; i < out.wrong.size(); ++i) {
    const cv::Rect tile = tile_of(i, image.size());
    out.wrong[i] = tile.area() ? static_cast<double>(cv::countNonZero(wrong(tile))) / tile.area() : 0;
  }
  out.worst = static_cast<std::size_t>(std::ranges::max_element(out.wrong) - out.wrong.begin());
  out.exact_share = share_of(exact, seen);
  out.exact_wrong = share_of(wrong, exact);
  if (picture.instant < begin_ || surprised) return out;
  const cv::Mat patches = patches_of(wrong);
  out.comparison = comparison_of(off, patches, seen);
  assumed_ = kAssumed * static_cast<double>(seen.total());
  add(count(seen, picture.doubt, wrong), of_late_);
  add(count(seen & ~patches, picture.doubt, wrong), beside_patches_);
  learn();
  return out;
}

ShownFidelity::ByKind ShownFidelity::count(const cv::Mat& seen, const cv::Mat& doubt, const cv::Mat& wrong) {
  ByKind out{};
  for (int y = 0; y < seen.rows; ++y)
    for (int x = 0; x < seen.cols; ++x) {
      const std::size_t kind = doubt.at<uchar>(y, x);
      if (!seen.at<uchar>(y, x) || kind >= out.size()) continue;
      out[kind].all += 1;
      out[kind].wrong += wrong.at<uchar>(y, x) ? 1 : 0;
    }
  return out;
}

void ShownFidelity::add(const ByKind& counts, ByKind& to) {
  for (std::size_t i = 0; i < counts.size(); ++i) {
    to[i].all = kMemory * to[i].all + counts[i].all;
    to[i].wrong = kMemory * to[i].wrong + counts[i].wrong;
  }
}

void ShownFidelity::learn() {
  for (std::size_t i = 0; i < risks_.size(); ++i) {
    if (is_coded_away(i)) continue;
    const double risk = assumed_risk(i, options_.wrong_levels);
    risks_[i] = (of_late_[i].wrong + assumed_ * risk) / (of_late_[i].all + assumed_);
  }
  learn_coded_away();
}

// What coding took away comparisons hardly tell: it comes on top of what is wrong elsewhere at such a contrast.
void ShownFidelity::learn_coded_away() {
  std::array<Counts, kLossContrasts> elsewhere{};
  for (int doubt = 0; doubt < kCodedAway; ++doubt) {
    Counts& at_contrast = elsewhere[static_cast<std::size_t>(loss_contrast(kind_of(doubt).contrast))];
    at_contrast.all += of_late_[static_cast<std::size_t>(doubt)].all;
    at_contrast.wrong += of_late_[static_cast<std::size_t>(doubt)].wrong;
  }
  for (int contrast = 0; contrast < kLossContrasts; ++contrast) {
    const auto& [all, wrong] = elsewhere[static_cast<std::size_t>(contrast)];
    const int middle = kStepsAContrast * contrast + kStepsAContrast / 2;
    const double assumed = assumed_risk(static_cast<std::size_t>(doubt_of({middle})), options_.wrong_levels);
    const double beside = (wrong + assumed_ * assumed) / (all + assumed_);
    for (int step = 1; step <= kToldSteps; ++step)
      risks_[static_cast<std::size_t>(coded_away(step, contrast))] =
          std::min(1.0, beside + lost_[static_cast<std::size_t>(step - 1)][static_cast<std::size_t>(contrast)]);
  }
  risks_[kMostlyCodedAway] = 1;
}

void ShownFidelity::choose(const ByKind& pixels) {
  std::array<std::size_t, kKindsEnd> order;
  std::iota(order.begin(), order.end(), 0);
  std::ranges::stable_sort(order, {}, [this](std::size_t i) { return risks_[i]; });
  exact_.reset();
  double all = 0, wrong = 0;
  for (const std::size_t i : order) {
    all += pixels[i].all;
    wrong += pixels[i].all * (risks_[i] + smoothed_);
    if (risks_[i] > options_.wrong_of_kind) return;
    if (all > 0 ? wrong > options_.wrong_share * all : risks_[i] > options_.wrong_share) return;
    exact_.set(i);
  }
}

}  // namespace foresight

#include "pictures/image_metrics.hpp"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <stdexcept>

#include "pictures/view_alpha.hpp"

namespace foresight {
namespace {

constexpr int kWindow = 11;  // SSIM window
constexpr int kHalo = kWindow / 2;
constexpr double kSigma = 1.5;
constexpr int kStripRows = 64;  // so that the six planes of a strip stay in the cache

cv::Mat bgr_of(const cv::Mat& picture) {
  if (picture.type() == CV_8UC3) return picture;
  cv::Mat bgr;
  cv::cvtColor(picture, bgr, cv::COLOR_BGRA2BGR);
  return bgr;
}

void check_picture(const cv::Mat& picture) {
  if (picture.empty() || (picture.type() != CV_8UC3 && picture.type() != CV_8UC4))
    throw std::invalid_argument("a picture must be 8-bit BGR or BGRA and hold pixels");
}

// Mean gradient magnitude over `where`; 0 where nothing counts.
double mean_gradient(const cv::Mat& luma, const cv::Mat& where) {
  cv::Mat gx, gy;
  cv::Sobel(luma, gx, CV_16S, 1, 0);
  cv::Sobel(luma, gy, CV_16S, 0, 1);
  double sum = 0;
  long count = 0;
  for (int y = 0; y < luma.rows; ++y) {
    const auto* x_row = gx.ptr<short>(y);
    const auto* y_row = gy.ptr<short>(y);
    const auto* inside = where.ptr<uchar>(y);
    for (int x = 0; x < luma.cols; ++x) {
      if (!inside[x]) continue;
      sum += std::sqrt(static_cast<float>(x_row[x] * x_row[x] + y_row[x] * y_row[x]));
      ++count;
    }
  }
  return count ? sum / static_cast<double>(count) : 0;
}

cv::Mat blurred(const cv::Mat& plane) {
  cv::Mat out;
  cv::GaussianBlur(plane, out, {kWindow, kWindow}, kSigma, kSigma, cv::BORDER_CONSTANT);
  return out;
}

// Adds the SSIM of rows [first, last) to `sum`, and the number of counted pixels to `count`.
struct SsimStrip {
  const cv::Mat& actual;
  const cv::Mat& shown;
  const cv::Mat& seen;
  double sum = 0;
  long count = 0;

  void add(int first, int last) {
    const int top = std::max(0, first - kHalo), bottom = std::min(actual.rows, last + kHalo);
    // Around mid grey, so that single precision keeps the small difference E[x^2] - E[x]^2.
    cv::Mat mask, a, b;
    seen.rowRange(top, bottom).convertTo(mask, CV_32F);
    actual.rowRange(top, bottom).convertTo(a, CV_32F, 1, -128);
    shown.rowRange(top, bottom).convertTo(b, CV_32F, 1, -128);
    a = a.mul(mask);
    b = b.mul(mask);
    const cv::Mat weight = blurred(mask), mean_a = blurred(a), mean_b = blurred(b);
    const cv::Mat aa = blurred(a.mul(a)), bb = blurred(b.mul(b)), ab = blurred(a.mul(b));
    for (int y = first - top; y < last - top; ++y)
      add_row(mask.ptr<float>(y), weight.ptr<float>(y), mean_a.ptr<float>(y), mean_b.ptr<float>(y), aa.ptr<float>(y),
              bb.ptr<float>(y), ab.ptr<float>(y));
  }

  void add_row(const float* mask, const float* weight, const float* mean_a, const float* mean_b, const float* aa,
               const float* bb, const float* ab) {
    constexpr float c1 = 0.01F * 255 * 0.01F * 255, c2 = 0.03F * 255 * 0.03F * 255;
    for (int x = 0; x < actual.cols; ++x) {
      if (mask[x] == 0 || weight[x] < 0.5F) continue;
      const float scale = 1 / weight[x];
      const float ma = mean_a[x] * scale, mb = mean_b[x] * scale;
      const float var_a = std::max(0.F, aa[x] * scale - ma * ma), var_b = std::max(0.F, bb[x] * scale - mb * mb);
      const float cov = ab[x] * scale - ma * mb;
      const float la = ma + 128, lb = mb + 128;
      sum += (2 * la * lb + c1) * (2 * cov + c2) / ((la * la + lb * lb + c1) * (var_a + var_b + c2));
      ++count;
    }
  }
};

}  // namespace

std::optional<double> Coverage::coloured_of_model() const {
  const double model = seen + filled + uncoloured;
  if (model <= 0) return std::nullopt;
  return (seen + filled) / model;
}

Coverage measure_coverage(const cv::Mat& predicted) {
  if (predicted.empty() || predicted.type() != CV_8UC4)
    throw std::invalid_argument("a predicted picture must be 8-bit BGRA and hold pixels");
  long none = 0, uncoloured = 0, filled = 0;
  for (int y = 0; y < predicted.rows; ++y) {
    const auto* row = predicted.ptr<cv::Vec4b>(y);
    for (int x = 0; x < predicted.cols; ++x) {
      const int alpha = row[x][3];
      none += alpha == view_alpha::kNoModel;
      uncoloured += alpha > view_alpha::kNoModel && alpha < view_alpha::kFromFill;
      filled += alpha >= view_alpha::kFromFill && alpha < view_alpha::kFromImage;
    }
  }
  const auto all = static_cast<double>(predicted.total());
  const auto share = [all](long n) { return static_cast<double>(n) / all; };
  const long seen = static_cast<long>(predicted.total()) - none - uncoloured - filled;
  return {share(seen), share(filled), share(uncoloured), share(none)};
}

cv::Mat seen_mask(const cv::Mat& predicted) {
  if (predicted.type() != CV_8UC4) throw std::invalid_argument("a predicted picture must be 8-bit BGRA");
  cv::Mat alpha;
  cv::extractChannel(predicted, alpha, 3);
  return alpha == view_alpha::kFromImage;
}

ImageComparison::ImageComparison(const cv::Mat& actual, const cv::Mat& seen) {
  check_picture(actual);
  if (seen.type() != CV_8UC1 || seen.size() != actual.size())
    throw std::invalid_argument("the mask must be CV_8UC1 and as large as the image");
  actual_ = bgr_of(actual);
  cv::cvtColor(actual_, actual_luma_, cv::COLOR_BGR2GRAY);
  seen_ = cv::min(seen, 1);
  seen_count_ = cv::countNonZero(seen_);
  cv::erode(seen_, inner_, cv::Mat::ones(5, 5, CV_8U));
  actual_gradient_ = mean_gradient(actual_luma_, inner_);
}

cv::Mat ImageComparison::luma_of(const cv::Mat& shown) const {
  check_picture(shown);
  if (shown.size() != actual_.size()) throw std::invalid_argument("the compared pictures differ in size");
  cv::Mat luma;
  cv::cvtColor(shown, luma, shown.channels() == 4 ? cv::COLOR_BGRA2GRAY : cv::COLOR_BGR2GRAY);
  return luma;
}

std::optional<double> ImageComparison::psnr_db(const cv::Mat& shown) const {
  check_picture(shown);
  if (shown.size() != actual_.size()) throw std::invalid_argument("the compared pictures differ in size");
  if (seen_count_ == 0) return std::nullopt;
  const double squares = cv::norm(actual_, bgr_of(shown), cv::NORM_L2SQR, seen_);
  if (squares == 0) return kMaxPsnr;
  return std::min(kMaxPsnr, 10 * std::log10(255.0 * 255.0 * 3 * seen_count_ / squares));
}

std::optional<double> ImageComparison::ssim(const cv::Mat& shown) const {
  const cv::Mat luma = luma_of(shown);
  SsimStrip strip{actual_luma_, luma, seen_};
  for (int row = 0; row < luma.rows; row += kStripRows) strip.add(row, std::min(luma.rows, row + kStripRows));
  if (strip.count == 0) return std::nullopt;
  return strip.sum / static_cast<double>(strip.count);
}

std::optional<double> ImageComparison::sharpness(const cv::Mat& shown) const {
  const cv::Mat luma = luma_of(shown);
  if (actual_gradient_ <= 0) return std::nullopt;
  return mean_gradient(luma, inner_) / actual_gradient_;
}

ImageQuality ImageComparison::measure(const cv::Mat& shown) const {
  return {psnr_db(shown), ssim(shown), sharpness(shown)};
}

}  // namespace foresight

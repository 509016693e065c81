#include "apps/replay_report/instants.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <stdexcept>

#include "pictures/view_alpha.hpp"

namespace foresight {
namespace {

using Palette = std::array<cv::Vec3b, 256>;

// Starts at a dark blue, not at black: "no error" must differ from "nothing seen".
Palette make_palette() {
  cv::Mat ramp(1, 256, CV_8U), colours;
  for (int i = 0; i < 256; ++i) ramp.at<uchar>(0, i) = cv::saturate_cast<uchar>(20 + i * 225.0 / 255);
  cv::applyColorMap(ramp, colours, cv::COLORMAP_INFERNO);
  Palette palette;
  std::copy_n(colours.ptr<cv::Vec3b>(), 256, palette.begin());
  return palette;
}

const Palette& palette() {
  static const Palette colours = make_palette();
  return colours;
}

// Diagonal stripes whose period follows the picture's width, so that they survive scaling.
bool on_hatch(int x, int y, int period) {
  return (x + y) % period < std::max(1, period / 3);
}

cv::Mat compose(const cv::Mat& predicted) {
  cv::Mat out(predicted.size(), CV_8UC3);
  for (int y = 0; y < out.rows; ++y)
    for (int x = 0; x < out.cols; ++x) {
      const auto& p = predicted.at<cv::Vec4b>(y, x);
      out.at<cv::Vec3b>(y, x) = p[3] >= view_alpha::kFromFill ? cv::Vec3b(p[0], p[1], p[2])
                                : p[3]                        ? kUncolouredColour
                                                              : kNoModelColour;
    }
  return out;
}

cv::Mat scaled(const cv::Mat& picture, int width) {
  if (picture.cols <= width) return picture.clone();
  const int height = std::max(1, static_cast<int>(std::lround(1.0 * picture.rows * width / picture.cols)));
  cv::Mat out;
  cv::resize(picture, out, {width, height}, 0, 0, cv::INTER_AREA);
  return out;
}

}  // namespace

cv::Vec3b error_colour(double share) {
  return palette()[static_cast<std::size_t>(std::lround(std::clamp(share, 0.0, 1.0) * 255))];
}

cv::Mat error_picture(const cv::Mat& predicted, const cv::Mat& actual) {
  if (predicted.type() != CV_8UC4 || actual.type() != CV_8UC3 || predicted.size() != actual.size())
    throw std::invalid_argument("an error picture needs a BGRA and a BGR picture of one size");
  cv::Mat out(actual.size(), CV_8UC3);
  const int period = std::max(3, actual.cols / 80);
  for (int y = 0; y < out.rows; ++y)
    for (int x = 0; x < out.cols; ++x) {
      const auto& p = predicted.at<cv::Vec4b>(y, x);
      const auto& a = actual.at<cv::Vec3b>(y, x);
      auto& o = out.at<cv::Vec3b>(y, x);
      if (p[3] == view_alpha::kFromImage) {
        const int error = std::max({std::abs(p[0] - a[0]), std::abs(p[1] - a[1]), std::abs(p[2] - a[2])});
        o = error_colour(error / kErrorRange);
      } else if (p[3] >= view_alpha::kFromFill) {
        o = on_hatch(x, y, period) ? kFilledColour : kNoModelColour;
      } else {
        o = p[3] ? kUncolouredColour : kNoModelColour;
      }
    }
  return out;
}

Instant make_instant(const FrameRecord& frame, const cv::Mat& delayed, const cv::Mat& predicted, const cv::Mat& actual,
                     int max_width) {
  const cv::Mat error = error_picture(predicted, actual);
  return {frame, scaled(delayed, max_width), scaled(compose(predicted), max_width), scaled(actual, max_width),
          scaled(error, max_width)};
}

InstantKeeper::InstantKeeper(std::size_t wanted, int max_width)
    : wanted_(std::max<std::size_t>(1, wanted)), max_width_(max_width) {}

void InstantKeeper::offer(const FrameRecord& frame, const cv::Mat& delayed, const cv::Mat& predicted,
                          const cv::Mat& actual) {
  if (offered_++ % stride_ != 0) return;
  if (kept_.size() == 2 * wanted_) {
    for (std::size_t i = 1; i < wanted_; ++i) kept_[i] = std::move(kept_[2 * i]);
    kept_.resize(wanted_);
    stride_ *= 2;
    // Full after an even number of instants, so this one is in step with the new stride too.
  }
  kept_.push_back(make_instant(frame, delayed, predicted, actual, max_width_));
}

std::vector<Instant> InstantKeeper::instants() const {
  if (kept_.size() <= wanted_) return kept_;
  std::vector<Instant> chosen;
  for (std::size_t i = 0; i < wanted_; ++i) chosen.push_back(kept_[(2 * i + 1) * kept_.size() / (2 * wanted_)]);
  return chosen;
}

}  // namespace foresight

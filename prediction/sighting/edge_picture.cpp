#include "prediction/sighting/edge_picture.hpp"

#include <cmath>
#include <numbers>
#include <opencv2/imgproc.hpp>
#include <stdexcept>

namespace foresight {
namespace {

constexpr double kBlur = 0.8;  // px: noise of single pixels is no edge
constexpr int kDirections = 8, kSpread = 2;
constexpr float kSobel = 8;  // what Sobel's masks add up to

int direction_of(double x, double y) {
  const double angle = std::atan2(y, x) / std::numbers::pi;  // -1 .. 1; opposite ones are one
  const int out = static_cast<int>(std::floor((angle + 1) * kDirections + 0.5));
  return out % kDirections;
}

}  // namespace

EdgePicture::EdgePicture(const cv::Mat& pixels) {
  if (pixels.type() != CV_8UC1 && pixels.type() != CV_8UC3)
    throw std::invalid_argument("EdgePicture: pictures are CV_8UC1 or CV_8UC3");
  cv::GaussianBlur(pixels, smooth_[0], {}, kBlur);
  constexpr int kWide = 2 * static_cast<int>(kReach[1]) - 1;
  cv::blur(pixels, smooth_[1], {kWide, kWide});
  find_slopes();
  spread();
}

std::optional<Eigen::Vector3d> EdgePicture::colour(std::size_t level, const Eigen::Vector2d& pixel) const {
  const cv::Mat& from = smooth_[level];
  const double x = std::floor(pixel.x()), y = std::floor(pixel.y());
  if (!(x >= 0 && y >= 0 && x < from.cols - 1 && y < from.rows - 1)) return std::nullopt;
  const double a = pixel.x() - x, b = pixel.y() - y;
  const int channels = from.channels(), column = static_cast<int>(x), row = static_cast<int>(y);
  const std::uint8_t* const above = from.ptr<std::uint8_t>(row) + channels * column;
  const std::uint8_t* const below = from.ptr<std::uint8_t>(row + 1) + channels * column;
  const auto value = [&](int c) {
    return (1 - b) * ((1 - a) * above[c] + a * above[c + channels]) +
           b * ((1 - a) * below[c] + a * below[c + channels]);
  };
  if (channels == 1) return Eigen::Vector3d::Constant(value(0));
  return Eigen::Vector3d(value(0), value(1), value(2));
}

void EdgePicture::find_slopes() {
  cv::Mat x, y;
  cv::Sobel(smooth_[0], x, CV_16S, 1, 0);
  cv::Sobel(smooth_[0], y, CV_16S, 0, 1);
  const int channels = smooth_[0].channels();
  slopes_.create(smooth_[0].size(), CV_32FC2);
  for (int row = 0; row < slopes_.rows; ++row) {
    const short *a = x.ptr<short>(row), *b = y.ptr<short>(row);
    auto* const out = slopes_.ptr<cv::Vec2f>(row);
    for (int column = 0; column < slopes_.cols; ++column) {
      int best = -1, bx = 0, by = 0;
      for (int c = 0; c < channels; ++c, ++a, ++b) {
        const int size = *a * *a + *b * *b;
        if (size <= best) continue;
        best = size;
        bx = *a;
        by = *b;
      }
      out[column] = {static_cast<float>(bx) / kSobel, static_cast<float>(by) / kSobel};
    }
  }
}

void EdgePicture::spread() {
  const cv::Size half(slopes_.cols / 2, slopes_.rows / 2);
  cv::Mat edges(half, CV_8UC1, cv::Scalar(0));
  for (int row = 0; row < half.height; ++row)
    for (int column = 0; column < half.width; ++column)
      for (int k = 0; k < 4; ++k) {
        const cv::Vec2f& s = slopes_.at<cv::Vec2f>(2 * row + k / 2, 2 * column + k % 2);
        if (s[0] * s[0] + s[1] * s[1] < kLeastSlope * kLeastSlope) continue;
        edges.at<std::uint8_t>(row, column) |= static_cast<std::uint8_t>(1 << direction_of(s[0], s[1]));
      }
  spread_ = cv::Mat(half, CV_8UC1, cv::Scalar(0));
  for (int y = -kSpread; y <= kSpread; ++y)
    for (int x = -kSpread; x <= kSpread; ++x) {
      const cv::Rect from = cv::Rect(x, y, half.width, half.height) & cv::Rect({}, half);
      const cv::Rect to = from - cv::Point(x, y);
      if (from.empty()) continue;
      cv::bitwise_or(spread_(to), edges(from), spread_(to));
    }
}

Eigen::Vector2d EdgePicture::slope(const Eigen::Vector2d& pixel) const {
  const double x = std::floor(pixel.x()), y = std::floor(pixel.y());
  if (!(x >= 0 && y >= 0 && x < slopes_.cols - 1 && y < slopes_.rows - 1)) return Eigen::Vector2d::Zero();
  const auto a = static_cast<float>(pixel.x() - x), b = static_cast<float>(pixel.y() - y);
  const auto* const above = slopes_.ptr<cv::Vec2f>(static_cast<int>(y)) + static_cast<int>(x);
  const auto* const below = slopes_.ptr<cv::Vec2f>(static_cast<int>(y) + 1) + static_cast<int>(x);
  const cv::Vec2f out = (1 - b) * ((1 - a) * above[0] + a * above[1]) + b * ((1 - a) * below[0] + a * below[1]);
  return {out[0], out[1]};
}

bool EdgePicture::edge_near(const Eigen::Vector2d& pixel, const Eigen::Vector2d& normal) const {
  const double x = std::floor(pixel.x() / 2), y = std::floor(pixel.y() / 2);
  if (!(x >= 0 && y >= 0 && x < spread_.cols && y < spread_.rows)) return false;
  const int direction = direction_of(normal.x(), normal.y());
  const int wanted =
      1 << direction | 1 << (direction + 1) % kDirections | 1 << (direction + kDirections - 1) % kDirections;
  return (spread_.at<std::uint8_t>(static_cast<int>(y), static_cast<int>(x)) & wanted) != 0;
}

}  // namespace foresight

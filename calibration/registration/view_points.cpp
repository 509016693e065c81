#include "calibration/registration/view_points.hpp"

#include <opencv2/imgproc.hpp>

#include "calibration/registration/projection_slope.hpp"
#include "common/rotation.hpp"
#include "pictures/view_alpha.hpp"

namespace foresight {
namespace {

constexpr int kBlock = 16;          // px
constexpr double kSmoothing = 0.7;  // px, before slopes are taken

/// Largest block parity pattern: judging blocks lie on a lattice that no row or column escapes.
int block_of(const Eigen::Vector2d& pixel, int width) {
  const int across = (width + kBlock - 1) / kBlock | 1;  // odd, so that the lattice shifts from row to row
  return static_cast<int>(pixel.y() + 0.5) / kBlock * across + static_cast<int>(pixel.x() + 0.5) / kBlock;
}

/// A surface point and how its pixel moves with the camera.
std::optional<ViewPoint> view_point(const Lens& lens, const RenderedView& view, const Eigen::Vector2d& pixel) {
  const int u = static_cast<int>(std::lround(pixel.x())), v = static_cast<int>(std::lround(pixel.y()));
  const auto ray = lens.unproject(pixel);
  if (!ray || u < 0 || v < 0 || u >= view.range.cols || v >= view.range.rows) return std::nullopt;
  const double range = view.range.at<float>(v, u);
  if (!(range > 0)) return std::nullopt;
  ViewPoint point;
  point.p_view = *ray * range;
  const auto slope = projection_slope(lens, point.p_view);
  if (!slope) return std::nullopt;
  // The camera moves by (w, t): a point of the scene moves by -w x p - t in its frame.
  point.displacement << *slope * cross_matrix(point.p_view), -*slope;
  point.block = block_of(pixel, view.range.cols);
  return point;
}

}  // namespace

std::vector<cv::Mat> grey_pyramid(const cv::Mat& picture, int levels) {
  cv::Mat grey;
  if (picture.channels() == 1)
    grey = picture;
  else
    cv::cvtColor(picture, grey, picture.channels() == 4 ? cv::COLOR_BGRA2GRAY : cv::COLOR_BGR2GRAY);
  std::vector<cv::Mat> pyramid(1);
  grey.convertTo(pyramid[0], CV_32F);
  for (int level = 1; level < levels; ++level) {
    cv::Mat half;
    const cv::Size size((pyramid.back().cols + 1) / 2, (pyramid.back().rows + 1) / 2);
    cv::Mat even;
    cv::copyMakeBorder(pyramid.back(), even, 0, 2 * size.height - pyramid.back().rows, 0,
                       2 * size.width - pyramid.back().cols, cv::BORDER_REPLICATE);
    cv::resize(even, half, size, 0, 0, cv::INTER_AREA);
    pyramid.push_back(half);
  }
  for (cv::Mat& level : pyramid) cv::GaussianBlur(level, level, {}, kSmoothing);
  return pyramid;
}

cv::Mat evidence_mask(const RenderedView& view, const RefinementOptions& options) {
  cv::Mat alpha;
  cv::extractChannel(view.colour, alpha, 3);
  cv::Mat mask = alpha == view_alpha::kFromImage;
  for (int v = 0; v < mask.rows; ++v)
    for (int u = 0; u < mask.cols; ++u) {
      const float here = view.range.at<float>(v, u);
      const auto steps = [&](int x, int y) {
        return x < mask.cols && y < mask.rows &&
               std::abs(view.range.at<float>(y, x) - here) >
                   options.range_step * std::max(here, view.range.at<float>(y, x));
      };
      if (steps(u + 1, v) || steps(u, v + 1)) mask.at<std::uint8_t>(v, u) = 0;
    }
  const int side = 2 * options.edge_px + 1;
  cv::erode(mask, mask, cv::getStructuringElement(cv::MORPH_RECT, {side, side}));
  return mask;
}

std::vector<ViewPoint> find_view_points(const Lens& lens, const RenderedView& view, const cv::Mat& values,
                                        const cv::Mat& mask, int level, const RefinementOptions& options) {
  const int scale = 1 << level;
  const double offset = (scale - 1) / 2.0;
  const auto slope_at = [&](int u, int v) -> Eigen::RowVector2d {
    return {(values.at<float>(v, u + 1) - values.at<float>(v, u - 1)) / 2,
            (values.at<float>(v + 1, u) - values.at<float>(v - 1, u)) / 2};
  };
  std::vector<ViewPoint> points;
  const int cell = level >= 2 ? 1 : (level == 1 ? 2 : 3);
  for (int v0 = 1; v0 + cell < values.rows; v0 += cell)
    for (int u0 = 1; u0 + cell < values.cols; u0 += cell) {
      double best = options.least_gradient * options.least_gradient;
      int u = -1, v = -1;
      for (int y = v0; y < v0 + cell; ++y)
        for (int x = u0; x < u0 + cell; ++x) {
          const int mu = std::min(x * scale + scale / 2, mask.cols - 1),
                    mv = std::min(y * scale + scale / 2, mask.rows - 1);
          const double size = slope_at(x, y).squaredNorm();
          if (size > best && mask.at<std::uint8_t>(mv, mu)) best = size, u = x, v = y;
        }
      if (u < 0) continue;
      auto point = view_point(lens, view, {u * scale + offset, v * scale + offset});
      if (!point) continue;
      point->value = values.at<float>(v, u);
      point->slope = slope_at(u, v) / scale * point->displacement;
      points.push_back(*point);
    }
  return points;
}

std::optional<double> sample(const cv::Mat& values, const Eigen::Vector2d& pixel) {
  const double x = std::floor(pixel.x()), y = std::floor(pixel.y());
  if (!(x >= 0 && y >= 0 && x + 1 < values.cols && y + 1 < values.rows)) return std::nullopt;
  const int u = static_cast<int>(x), v = static_cast<int>(y);
  const double a = pixel.x() - x, b = pixel.y() - y;
  const float *top = values.ptr<float>(v) + u, *bottom = values.ptr<float>(v + 1) + u;
  return (1 - b) * ((1 - a) * top[0] + a * top[1]) + b * ((1 - a) * bottom[0] + a * bottom[1]);
}

}  // namespace foresight

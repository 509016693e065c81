#include "calibration/result/heat_map.hpp"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <stdexcept>
#include <vector>

#include "common/html_page.hpp"
#include "common/statistics.hpp"
#include "common/svg_plot.hpp"
#include "common/text.hpp"
#include "pictures/encode.hpp"

namespace foresight {
namespace {

// In user units, as in common/svg_plot.cpp: both stand side by side on a page.
constexpr double kBothWidth = 560, kLeft = 44, kTop = 20, kMapWidth = 420, kBarLeft = 486, kBarWidth = 16, kBottom = 30;
constexpr double kSmallest = 1e-12;  // range of the bar
constexpr int kBarSteps = 64;

SvgPlot::Range range_of(const cv::Mat& values) {
  std::vector<double> finite;
  for (auto it = values.begin<double>(); it != values.end<double>(); ++it)
    if (std::isfinite(*it)) finite.push_back(*it);
  if (finite.empty()) return {0, 1};
  const double least = *std::min_element(finite.begin(), finite.end()), most = quantile(std::move(finite), 0.98);
  if (most - least > kSmallest) return {least, most};
  return {least, least + std::max(kSmallest, std::abs(least))};
}

cv::Mat coloured(const cv::Mat& values, SvgPlot::Range range) {
  cv::Mat levels(values.size(), CV_8U), colours;
  for (int y = 0; y < values.rows; ++y)
    for (int x = 0; x < values.cols; ++x) {
      const double share = (values.at<double>(y, x) - range.min) / (range.max - range.min);
      levels.at<uchar>(y, x) = static_cast<uchar>(std::isfinite(share) ? 255 * std::clamp(share, 0.0, 1.0) : 0);
    }
  cv::applyColorMap(levels, colours, cv::COLORMAP_VIRIDIS);
  cv::cvtColor(colours, colours, cv::COLOR_BGR2BGRA);
  for (int y = 0; y < values.rows; ++y)
    for (int x = 0; x < values.cols; ++x)
      if (!std::isfinite(values.at<double>(y, x))) colours.at<cv::Vec4b>(y, x) = {0, 0, 0, 0};
  return colours;
}

std::string number(double v) {
  return readable(v, 1);
}

std::string picture(const cv::Mat& colours, double x, double y, double width, double height) {
  const std::vector<std::uint8_t> png = encode_png(colours);
  return "<image x=\"" + number(x) + "\" y=\"" + number(y) + "\" width=\"" + number(width) + "\" height=\"" +
         number(height) + "\" preserveAspectRatio=\"none\" href=\"" + data_uri("image/png", png) + "\"/>";
}

std::string frame(double x, double y, double width, double height) {
  return "<rect class=\"frame\" x=\"" + number(x) + "\" y=\"" + number(y) + "\" width=\"" + number(width) +
         "\" height=\"" + number(height) + "\"/>";
}

std::string text_at(double x, double y, const char* anchor, const std::string& text) {
  return "<text x=\"" + number(x) + "\" y=\"" + number(y) + "\" text-anchor=\"" + anchor + "\">" + escape_html(text) +
         "</text>";
}

// Enough places to tell the ends of the bar apart.
int digits_for(SvgPlot::Range range) {
  return std::clamp(static_cast<int>(std::ceil(2 - std::log10(range.max - range.min))), 0, 9);
}

std::string bar(SvgPlot::Range range, double height, const std::string& unit) {
  cv::Mat steps(kBarSteps, 1, CV_64F);
  for (int i = 0; i < kBarSteps; ++i)
    steps.at<double>(i) = range.max - (range.max - range.min) * i / double{kBarSteps - 1};
  std::string out =
      picture(coloured(steps, range), kBarLeft, kTop, kBarWidth, height) + frame(kBarLeft, kTop, kBarWidth, height);
  for (const double t : round_ticks(range, 5)) {
    const double y = kTop + height * (1 - (t - range.min) / (range.max - range.min));
    out += text_at(kBarLeft + kBarWidth + 6, y + 4, "start", readable(t, digits_for(range)));
  }
  return out + text_at(kBarLeft, kTop - 8, "start", unit);
}

}  // namespace

std::string heat_map_svg(const std::string& label, const cv::Mat& values, int width, int height,
                         const std::string& unit) {
  if (values.type() != CV_64F || values.empty() || width <= 0 || height <= 0)
    throw std::invalid_argument("a heat map needs CV_64F cells and an image size");
  const double scale = kMapWidth / width, map_height = scale * height;
  const SvgPlot::Range range = range_of(values);
  std::string out = "<svg viewBox=\"0 0 " + number(kBothWidth) + " " + number(kTop + map_height + kBottom) +
                    "\" role=\"img\" aria-label=\"" + escape_html(label) + "\">" +
                    picture(coloured(values, range), kLeft, kTop, kMapWidth, map_height) +
                    frame(kLeft, kTop, kMapWidth, map_height);
  for (const double t : round_ticks({0, static_cast<double>(width)}, 6))
    out += text_at(kLeft + scale * t, kTop + map_height + 18, "middle", readable(t, 0));
  for (const double t : round_ticks({0, static_cast<double>(height)}, 5))
    out += text_at(kLeft - 7, kTop + scale * t + 4, "end", readable(t, 0));
  return out + bar(range, map_height, unit) + "</svg>";
}

}  // namespace foresight

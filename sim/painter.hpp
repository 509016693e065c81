// Draws pictures in metres: the same drawing at any texel size.
#pragma once

#include <cstdint>
#include <opencv2/core.hpp>
#include <string>
#include <vector>

namespace foresight::sim {

/// sRGB colour, 0xRRGGBB.
cv::Scalar rgb(std::uint32_t hex);

/// Smooth noise in -1 .. 1 with features of size 1; the same for the same arguments everywhere.
float noise(float x, float y, std::uint32_t seed);
/// `octaves` of noise, each half as large and half as strong; about -1 .. 1.
float fractal_noise(float x, float y, int octaves, std::uint32_t seed);

/// A BGR picture of `width` by `height` metres. x goes right and y down from the top-left corner.
class Painter {
 public:
  Painter(double width, double height, double metres_per_texel, std::uint32_t background);

  double width() const { return width_; }
  double height() const { return height_; }
  const cv::Mat& picture() const { return picture_; }

  void rectangle(double x, double y, double w, double h, std::uint32_t colour);
  void frame(double x, double y, double w, double h, double line, std::uint32_t colour);
  void line(double x0, double y0, double x1, double y1, double line, std::uint32_t colour);
  void disc(double x, double y, double radius, std::uint32_t colour);
  void ring(double x, double y, double radius, double line, std::uint32_t colour);
  void polygon(const std::vector<cv::Point2d>& points, std::uint32_t colour);
  void grid(double x, double y, double w, double h, double pitch, double line, std::uint32_t colour);

  /// Capital letters of about `size` metres, their baseline's left end at (x, y). `stroke`: metres.
  void text(double x, double y, double size, double stroke, std::uint32_t colour, const std::string& words);
  /// Lines of grey bars like small print, filling the rectangle.
  void small_print(double x, double y, double w, double h, double pitch, std::uint32_t colour, std::uint32_t seed);
  void bar_code(double x, double y, double w, double h, std::uint32_t seed);

  /// Multiplies each texel by 1 + strength(x, y), x and y in metres; per channel the same.
  template <typename Strength>
  void modulate(Strength&& strength);

 private:
  cv::Point fixed(double x, double y) const;  // texel coordinates with kShift fraction bits
  int thickness(double line) const;

  double width_, height_, scale_;
  cv::Mat picture_;
};

template <typename Strength>
void Painter::modulate(Strength&& strength) {
  for (int y = 0; y < picture_.rows; ++y)
    for (int x = 0; x < picture_.cols; ++x) {
      const double s = 1 + strength((x + 0.5) / scale_, (y + 0.5) / scale_);
      auto& t = picture_.at<cv::Vec3b>(y, x);
      for (int c = 0; c < 3; ++c) t[c] = cv::saturate_cast<std::uint8_t>(t[c] * s);
    }
}

}  // namespace foresight::sim

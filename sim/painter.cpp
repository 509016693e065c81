#include "sim/painter.hpp"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

namespace foresight::sim {
namespace {

constexpr int kShift = 4;  // fraction bits of OpenCV's drawing functions
constexpr std::uint32_t kInk = 0x1b1b1f;

float mix(float a, float b, float t) {
  return a + t * (b - a);
}

std::uint32_t hash(std::int32_t x, std::int32_t y, std::uint32_t seed) {
  std::uint32_t h = static_cast<std::uint32_t>(x) * 0x8da6b343u ^ static_cast<std::uint32_t>(y) * 0xd8163841u ^
                    (seed + 1) * 0xcb1ab31fu;
  h = (h ^ (h >> 15)) * 0x2c1b3c6du;
  h = (h ^ (h >> 12)) * 0x297a2d39u;
  return h ^ (h >> 15);
}

float unit(std::uint32_t h) {
  return static_cast<float>(h >> 8) / 16777216.0f;
}

}  // namespace

cv::Scalar rgb(std::uint32_t hex) {
  return cv::Scalar(hex & 255, (hex >> 8) & 255, (hex >> 16) & 255);
}

float noise(float x, float y, std::uint32_t seed) {
  const float fx = std::floor(x), fy = std::floor(y);
  const int ix = static_cast<int>(fx), iy = static_cast<int>(fy);
  const auto smooth = [](float t) { return t * t * (3 - 2 * t); };
  const float a = smooth(x - fx), b = smooth(y - fy);
  const float top = mix(unit(hash(ix, iy, seed)), unit(hash(ix + 1, iy, seed)), a);
  const float bottom = mix(unit(hash(ix, iy + 1, seed)), unit(hash(ix + 1, iy + 1, seed)), a);
  return 2 * mix(top, bottom, b) - 1;
}

float fractal_noise(float x, float y, int octaves, std::uint32_t seed) {
  float sum = 0, strength = 0.5f;
  for (int i = 0; i < octaves; ++i, x *= 2, y *= 2, strength /= 2) sum += strength * noise(x, y, seed + 17 * i);
  return sum;
}

Painter::Painter(double width, double height, double metres_per_texel, std::uint32_t background)
    : width_(width), height_(height), scale_(1 / metres_per_texel) {
  const auto texels = [&](double metres) { return std::max(1, static_cast<int>(std::ceil(metres * scale_))); };
  picture_ = cv::Mat(texels(height), texels(width), CV_8UC3, rgb(background));
}

// OpenCV's pixel centres lie at integers; ours half a texel from the corner.
cv::Point Painter::fixed(double x, double y) const {
  const auto f = [&](double metres) { return static_cast<int>(std::lround((metres * scale_ - 0.5) * (1 << kShift))); };
  return {f(x), f(y)};
}

int Painter::thickness(double line) const {
  return std::max(1, static_cast<int>(std::lround(line * scale_)));
}

void Painter::rectangle(double x, double y, double w, double h, std::uint32_t colour) {
  polygon({{x, y}, {x + w, y}, {x + w, y + h}, {x, y + h}}, colour);
}

void Painter::polygon(const std::vector<cv::Point2d>& points, std::uint32_t colour) {
  std::vector<cv::Point> p;
  for (const auto& q : points) p.push_back(fixed(q.x, q.y));
  cv::fillPoly(picture_, std::vector<std::vector<cv::Point>>{p}, rgb(colour), cv::LINE_AA, kShift);
}

void Painter::frame(double x, double y, double w, double h, double width, std::uint32_t colour) {
  line(x, y, x + w, y, width, colour);
  line(x, y + h, x + w, y + h, width, colour);
  line(x, y, x, y + h, width, colour);
  line(x + w, y, x + w, y + h, width, colour);
}

void Painter::line(double x0, double y0, double x1, double y1, double width, std::uint32_t colour) {
  cv::line(picture_, fixed(x0, y0), fixed(x1, y1), rgb(colour), thickness(width), cv::LINE_AA, kShift);
}

void Painter::disc(double x, double y, double radius, std::uint32_t colour) {
  cv::circle(picture_, fixed(x, y), static_cast<int>(std::lround(radius * scale_ * (1 << kShift))), rgb(colour),
             cv::FILLED, cv::LINE_AA, kShift);
}

void Painter::ring(double x, double y, double radius, double width, std::uint32_t colour) {
  cv::circle(picture_, fixed(x, y), static_cast<int>(std::lround(radius * scale_ * (1 << kShift))), rgb(colour),
             thickness(width), cv::LINE_AA, kShift);
}

void Painter::grid(double x, double y, double w, double h, double pitch, double width, std::uint32_t colour) {
  for (double dx = 0; dx <= w + 1e-9; dx += pitch) line(x + dx, y, x + dx, y + h, width, colour);
  for (double dy = 0; dy <= h + 1e-9; dy += pitch) line(x, y + dy, x + w, y + dy, width, colour);
}

void Painter::text(double x, double y, double size, double stroke, std::uint32_t colour, const std::string& words) {
  constexpr double kCapHeight = 21;  // of the Hershey fonts at scale 1, in texels
  cv::putText(picture_, words, {static_cast<int>(std::lround(x * scale_)), static_cast<int>(std::lround(y * scale_))},
              cv::FONT_HERSHEY_DUPLEX, size * scale_ / kCapHeight, rgb(colour), thickness(stroke), cv::LINE_AA);
}

void Painter::small_print(double x, double y, double w, double h, double pitch, std::uint32_t colour,
                          std::uint32_t seed) {
  int row = 0;
  for (double dy = 0; dy + 0.5 * pitch <= h; dy += pitch, ++row) {
    const double end = w * (0.7 + 0.3 * unit(hash(row, 1, seed)));
    int word = 0;
    for (double dx = 0; dx < end; ++word) {
      const double length = pitch * (0.6 + 2.4 * unit(hash(row, 2 + word, seed)));
      rectangle(x + dx, y + dy, std::min(length, end - dx), 0.45 * pitch, colour);
      dx += length + 0.45 * pitch;
    }
  }
}

void Painter::bar_code(double x, double y, double w, double h, std::uint32_t seed) {
  rectangle(x, y, w, h, 0xf4f4f0);
  const double module = w / 64;
  int i = 0;
  for (double dx = 3 * module; dx < w - 6 * module; ++i) {
    const double bar = module * (1 + hash(i, 0, seed) % 3), gap = module * (1 + hash(i, 1, seed) % 3);
    rectangle(x + dx, y + 0.06 * h, bar, 0.78 * h, kInk);
    dx += bar + gap;
  }
}

}  // namespace foresight::sim

#include "sim/sensor.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <opencv2/imgproc.hpp>
#include <vector>

#include "sim/texture.hpp"

namespace foresight::sim {
namespace {

// Of the variance at mid grey; the rest is shot noise, which grows with the light.
constexpr double kReadShare = 0.2;

// Numbers from a counter, so that rows and images need no order (Steele et al., "Fast Splittable
// Pseudorandom Number Generators", OOPSLA 2014).
class Noise {
 public:
  explicit Noise(std::uint64_t key) : state_(key) {}

  // Two independent normal numbers (Box and Muller).
  std::array<float, 2> normal() {
    const double r = std::sqrt(-2 * std::log(1 - unit())), angle = 2 * std::numbers::pi * unit();
    return {static_cast<float>(r * std::cos(angle)), static_cast<float>(r * std::sin(angle))};
  }

 private:
  double unit() {
    state_ += 0x9e3779b97f4a7c15u;
    std::uint64_t z = state_;
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
    return static_cast<double>((z ^ (z >> 31)) >> 11) * 0x1p-53;
  }
  std::uint64_t state_;
};

}  // namespace

std::uint8_t encode(float light) {
  static const std::vector<std::uint8_t> table = [] {
    std::vector<std::uint8_t> t(32768);
    for (std::size_t i = 0; i < t.size(); ++i) {
      const float x = 4.0f * (static_cast<float>(i) + 0.5f) / static_cast<float>(t.size());
      const float y = x < 0.55f ? x : 0.55f + 0.45f * (1 - std::exp(-(x - 0.55f) / 0.45f));
      t[i] = static_cast<std::uint8_t>(std::lround(255 * std::clamp(srgb_from_linear(y), 0.0f, 1.0f)));
    }
    return t;
  }();
  const float place = std::clamp(light * static_cast<float>(table.size()) / 4.0f, 0.0f, 1e6f);
  return table[std::min(static_cast<std::size_t>(place), table.size() - 1)];
}

double Sensor::gain(double t) const {
  return exposure * (1 + exposure_drift * std::sin(2 * std::numbers::pi * t / kDriftPeriod));
}

double Sensor::falloff(double u, double v, cv::Size size) const {
  const double x = u - (size.width - 1) / 2.0, y = v - (size.height - 1) / 2.0;
  const double w = size.width - 1, h = size.height - 1;
  return 1 - vignetting * 4 * (x * x + y * y) / (w * w + h * h);
}

cv::Mat Sensor::develop(const cv::Mat& light, double t, std::uint64_t number, double factor) const {
  const float mid = linear_from_srgb(128 / 255.0f);
  const float slope = (srgb_from_linear(mid * 1.001f) - srgb_from_linear(mid)) / (mid * 0.001f);
  const float variance = std::pow(static_cast<float>(noise) / 255 / slope, 2.0f);
  const auto read = static_cast<float>(kReadShare) * variance, shot = (variance - read) / mid;
  cv::Mat spread = light;
  if (blur > 0) cv::GaussianBlur(light, spread, {}, blur);
  cv::Mat out(light.size(), CV_8UC3);
  for (int v = 0; v < light.rows; ++v) {
    Noise random((number << 20) + static_cast<std::uint64_t>(v) + (std::uint64_t{seed} << 52));
    for (int u = 0; u < light.cols; ++u) {
      cv::Vec3f value = spread.at<cv::Vec3f>(v, u) * static_cast<float>(factor * gain(t) * falloff(u, v, light.size()));
      if (noise > 0) {
        const auto a = random.normal(), b = random.normal();
        const float normal[] = {a[0], a[1], b[0]};
        for (int c = 0; c < 3; ++c) value[c] += std::sqrt(read + shot * value[c]) * normal[c];
      }
      out.at<cv::Vec3b>(v, u) = {encode(value[2]), encode(value[1]), encode(value[0])};
    }
  }
  return out;
}

}  // namespace foresight::sim

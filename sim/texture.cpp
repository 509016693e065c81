#include "sim/texture.hpp"

#include <algorithm>
#include <bit>
#include <cmath>

namespace foresight::sim {
namespace {

constexpr float kUnit = 65535.0f;

int mirrored(int i, int size) {
  if (i >= 0 && i < size) return i;
  const int period = 2 * size;
  i = ((i % period) + period) % period;
  return i < size ? i : period - 1 - i;
}

}  // namespace

float linear_from_srgb(float encoded) {
  return encoded <= 0.04045f ? encoded / 12.92f : std::pow((encoded + 0.055f) / 1.055f, 2.4f);
}

float srgb_from_linear(float linear) {
  return linear <= 0.0031308f ? linear * 12.92f : 1.055f * std::pow(linear, 1 / 2.4f) - 0.055f;
}

Texture::Texture(const cv::Mat& srgb, double metres_per_texel)
    : texels_per_metre_(static_cast<float>(1 / metres_per_texel)) {
  CV_Assert(srgb.type() == CV_8UC3 && !srgb.empty());
  std::array<std::uint16_t, 256> table{};
  for (int i = 0; i < 256; ++i)
    table[i] = static_cast<std::uint16_t>(std::lround(linear_from_srgb(static_cast<float>(i) / 255) * kUnit));

  Level base{srgb.cols, srgb.rows, {}};
  base.texels.reserve(srgb.total());
  for (int y = 0; y < srgb.rows; ++y)
    for (int x = 0; x < srgb.cols; ++x) {
      const auto& bgr = srgb.at<cv::Vec3b>(y, x);
      base.texels.push_back({table[bgr[2]], table[bgr[1]], table[bgr[0]], 0});
    }
  levels_.push_back(std::move(base));
  while (std::min(levels_.back().width, levels_.back().height) > 1) levels_.push_back(half(levels_.back()));

  const Level& last = levels_.back();
  for (const auto& t : last.texels) mean_ += Eigen::Vector3f(t[0], t[1], t[2]);
  mean_ /= kUnit * static_cast<float>(last.texels.size());
}

Texture::Level Texture::half(const Level& fine) {
  Level out{std::max(1, fine.width / 2), std::max(1, fine.height / 2), {}};
  out.texels.resize(static_cast<std::size_t>(out.width) * out.height);
  for (int y = 0; y < out.height; ++y)
    for (int x = 0; x < out.width; ++x)
      for (int c = 0; c < 3; ++c) {
        const auto at = [&](int dx, int dy) -> unsigned {
          return fine.texels[static_cast<std::size_t>(2 * y + dy) * fine.width + 2 * x + dx][c];
        };
        out.texels[static_cast<std::size_t>(y) * out.width + x][c] =
            static_cast<std::uint16_t>((at(0, 0) + at(1, 0) + at(0, 1) + at(1, 1) + 2) / 4);
      }
  return out;
}

Eigen::Vector3f Texture::sample(const Eigen::Vector2f& uv, float footprint) const {
  const auto texels = static_cast<unsigned>(std::clamp(footprint * texels_per_metre_, 1.0f, 1e6f));
  const int k = std::min<int>(std::bit_width(texels) - 1, static_cast<int>(levels_.size()) - 1);
  const Level& level = levels_[k];
  const float scale = texels_per_metre_ / static_cast<float>(1 << k);
  const float x = uv.x() * scale - 0.5f, y = uv.y() * scale - 0.5f;
  const float fx = std::floor(x), fy = std::floor(y);
  const int x0 = static_cast<int>(fx), y0 = static_cast<int>(fy);
  const float a = x - fx, b = y - fy;
  const int xs[2] = {mirrored(x0, level.width), mirrored(x0 + 1, level.width)};
  const auto* row0 = level.texels.data() + static_cast<std::size_t>(mirrored(y0, level.height)) * level.width;
  const auto* row1 = level.texels.data() + static_cast<std::size_t>(mirrored(y0 + 1, level.height)) * level.width;
  const auto colour = [](const std::array<std::uint16_t, 4>& t) { return Eigen::Vector3f(t[0], t[1], t[2]); };
  return ((1 - b) * ((1 - a) * colour(row0[xs[0]]) + a * colour(row0[xs[1]])) +
          b * ((1 - a) * colour(row1[xs[0]]) + a * colour(row1[xs[1]]))) *
         (1 / kUnit);
}

}  // namespace foresight::sim

// Surface colours of the lab: sRGB pictures, kept in linear light with a mip pyramid.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <opencv2/core.hpp>
#include <span>
#include <vector>

namespace foresight::sim {

/// sRGB to linear light (IEC 61966-2-1) and back; all in 0 .. 1.
float linear_from_srgb(float encoded);
float srgb_from_linear(float linear);

/// Immutable; safe to share between threads. Colours are linear RGB, 0 .. 1.
class Texture {
 public:
  /// `srgb`: CV_8UC3, BGR; one texel is a square of `metres_per_texel`.
  Texture(const cv::Mat& srgb, double metres_per_texel);

  /// Bilinear colour at `uv`, metres right of and below the top-left corner of the picture, from
  /// the coarsest level whose texels are not larger than `footprint` (metres). Mirrored outside.
  Eigen::Vector3f sample(const Eigen::Vector2f& uv, float footprint) const;

  /// Level `k` of the pyramid, 0 the finest: linear RGB and padding, 65535 is 1, row by row.
  struct LevelView {
    int width = 0, height = 0;
    std::span<const std::array<std::uint16_t, 4>> texels;
  };
  int level_count() const { return static_cast<int>(levels_.size()); }
  LevelView level(int k) const {
    const Level& l = levels_[static_cast<std::size_t>(k)];
    return {l.width, l.height, l.texels};
  }
  float texels_per_metre() const { return texels_per_metre_; }

  const Eigen::Vector3f& mean() const { return mean_; }

 private:
  struct Level {
    int width = 0, height = 0;
    std::vector<std::array<std::uint16_t, 4>> texels;  // linear RGB and padding
  };
  static Level half(const Level& fine);

  std::vector<Level> levels_;
  float texels_per_metre_ = 1;
  Eigen::Vector3f mean_ = Eigen::Vector3f::Zero();
};

}  // namespace foresight::sim

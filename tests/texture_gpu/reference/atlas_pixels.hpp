// The atlas and one generation of textures, copied to the CPU.
#pragma once

#include <Eigen/Core>
#include <array>
#include <functional>
#include <optional>
#include <vector>

#include "gl/objects.hpp"
#include "texture_gpu/atlas_layout.hpp"
#include "texture_gpu/published_textures.hpp"

namespace foresight::reference {

using Texel = std::array<std::uint8_t, 4>;  ///< R, G, B in steps of 255, and the code of atlas.glsl

/// All levels of the atlas's colours, in steps of 255; what is brighter than 255 counts as 255. Slots lie
/// 8 to a row, 512 rows to a layer.
struct AtlasPixels {
  explicit AtlasPixels(const gl::Texture& colours);

  /// Texel (x, y) of a slot at a level (side 16 >> level).
  Texel at(std::uint32_t slot, int level, int x, int y) const {
    return levels[static_cast<std::size_t>(level)][place(slot, level, x, y)];
  }
  static std::size_t place(std::uint32_t slot, int level, int x, int y);

  std::array<std::vector<Texel>, atlas::kLevels> levels;
};

/// One chart as chart_record.glsl says.
struct ChartCopy {
  Eigen::Vector3d origin, eu, ev, eh;
  int node = 0, first_page = 0;
  Eigen::Vector2i pages;
  Eigen::Vector2d uv0, density;
};

struct Generation {
  /// `charts`: how many the surface has.
  Generation(const PublishedTextures& published, std::size_t charts);
  std::vector<ChartCopy> charts;
  std::vector<std::uint32_t> table;
  std::vector<Eigen::Vector4d> coarse, means;
  float display_gain = 1, sharp = 0;
};

/// Alpha: the code's share of 31.
Eigen::Vector4d to_vector(const Texel& texel);

/// Texel `at` of a chart's level; 0 where it has none.
Eigen::Vector4d texel_of(const Generation& generation, const AtlasPixels& pixels, const ChartCopy& chart, int level,
                         const Eigen::Vector2i& at);

/// Calls `f` with each of the four neighbours of a place, centres at integers, and its weight.
template <typename F>
void bilinear(const Eigen::Vector2d& at, F&& f) {
  const Eigen::Vector2d base = at.array().floor(), part = at - base;
  for (int i = 0; i < 4; ++i)
    f(Eigen::Vector2i(base.cast<int>() + Eigen::Vector2i(i & 1, i >> 1)),
      (i & 1 ? part.x() : 1 - part.x()) * (i >> 1 ? part.y() : 1 - part.y()));
}

/// Catmull-Rom, in which the outer texels of each side are all as the one in the nearest row or column, without the
/// corners; nothing where one that it takes was not seen, at levels above 0: in part.
std::optional<Eigen::Vector3d> cubic(const Eigen::Vector2d& at, int level,
                                     const std::function<Eigen::Vector4d(const Eigen::Vector2i&)>& fetch);

}  // namespace foresight::reference

// The texels of one chart at one resolution, and the height of the surface at each.
#pragma once

#include <cstdint>
#include <vector>

#include "texture_gpu/surface_patches.hpp"

namespace foresight {

/// Texel (i, j) has its centre at (u, v) = uv0 + (i, j) / density, by element, on the patch's plane:
/// a surface that cameras see at a grazing angle has fewer texels along the line of sight. A guard
/// band around the triangles continues the surface, so that the four texels around any point of
/// it always exist and filtering never reaches into another chart (thesis, section 4.5).
struct ChartRaster {
  Eigen::Vector2d density{0, 0};   ///< texels per metre along u and v
  int width = 0, height = 0;       ///< texels
  Eigen::Vector2d uv0;             ///< metres on the patch's plane
  double height0 = 0;              ///< metres along n of raw value 1
  double height_step = 0;          ///< metres per unit of a raw value
  std::vector<std::uint16_t> raw;  ///< row-major; 0: no surface, else 1 + (h - height0) / height_step,
                                   ///< plus kCore inside the triangles (without it: guard band)
  static constexpr std::uint16_t kCore = 0x8000;
};

/// Size in texels that raster_chart() will give, without the work.
Eigen::Vector2i chart_size(const Chart& chart, const Eigen::Vector2d& density);

/// `density` > 0 in texels per metre along u and v.
ChartRaster raster_chart(const SurfacePatches& surface, int chart, const Eigen::Vector2d& density);

/// The scene triangle under the centre of each texel of raster_chart()'s result, row-major: the one
/// whose height it has. -1: none, that is guard band, or a triangle smaller than a texel.
std::vector<int> triangles_under(const SurfacePatches& surface, int chart, const ChartRaster& raster);

}  // namespace foresight

// The texels of one chart at one resolution, and the height of the surface at each.
#pragma once

#include <cstdint>
#include <vector>

#include "texture_gpu/surface_patches.hpp"

namespace foresight {

/// Texel (i, j) has its centre at (u, v) = uv0 + (i, j) / density on the patch's plane. A guard
/// band around the triangles continues the surface, so that the four texels around any point of
/// it always exist and filtering never reaches into another chart (thesis, section 4.5).
struct ChartRaster {
  double density = 0;              ///< texels per metre
  int width = 0, height = 0;       ///< texels
  Eigen::Vector2d uv0;             ///< metres on the patch's plane
  double height0 = 0;              ///< metres along n of raw value 1
  double height_step = 0;          ///< metres per unit of a raw value
  std::vector<std::uint16_t> raw;  ///< row-major; 0: no surface, else 1 + (h - height0) / height_step
};

/// Size in texels that raster_chart() will give, without the work.
Eigen::Vector2i chart_size(const Chart& chart, double density);

/// `density` > 0 in texels per metre.
ChartRaster raster_chart(const SurfacePatches& surface, int chart, double density);

}  // namespace foresight

// What is known of the surface within each tile of 8x8 texels: enough to tell without looking at
// its texels that a camera cannot see it.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "texture_gpu/chart_raster.hpp"

namespace foresight {

/// Bounds of all texels and triangles on a tile. Slopes are changes of height per step along u and v,
/// both in metres. Without texels: no surface.
struct TilePlane {
  float center = 0;     ///< height at the tile's centre, raw units of the ChartRaster
  float residual = -1;  ///< largest distance of any texel from the plane, raw units; below 0: no surface
  float offset = 0;     ///< planes of single triangles pass the centre within this, raw units
  Eigen::Vector2f slope{0, 0};
  Eigen::Vector2f spread{0, 0};     ///< slopes of single triangles differ from `slope` by up to this
  std::uint16_t low = 0, high = 0;  ///< lowest and highest raw height of a texel; 0: none
};

/// Row-major, (width + 7) / 8 by (height + 7) / 8 tiles.
std::vector<TilePlane> find_tile_planes(const SurfacePatches& surface, int chart, const ChartRaster& raster);

/// True where a viewer at `eye` (u, v, height; metres on the patch's plane) sees all triangles of
/// the tile from behind. (u, v) is the tile's centre.
bool faces_away(const TilePlane& tile, const ChartRaster& raster, const Eigen::Vector2d& uv,
                const Eigen::Vector3d& eye);

/// As cull.comp reads it: center and residual, slopes in raw units per texel; four half floats. Where
/// triangles of many slopes meet, a level plane may be the closer bound and is taken.
std::array<std::uint32_t, 2> packed(const TilePlane& tile, const ChartRaster& raster);

}  // namespace foresight

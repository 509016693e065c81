#include "texture_gpu/tile_planes.hpp"

#include <algorithm>
#include <limits>

#include "texture_gpu/atlas_layout.hpp"

namespace foresight {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double kGuardReach = 2;                     // texels beyond a triangle that take its height
constexpr double kHalfTile = atlas::kTile / 2.0;      // texels
constexpr double kCenter = (atlas::kTile - 1) / 2.0;  // of a tile, from its first texel

/// Range of values.
struct Span {
  double low = std::numeric_limits<double>::max(), high = -low;
  void include(double v) { low = std::min(low, v), high = std::max(high, v); }
  double middle() const { return (low + high) / 2; }
  double half() const { return (high - low) / 2; }
};

struct Bounds {
  Span center, slope_u, slope_v;  // metres
};

/// Calls f(tile, x, y, raw) for each texel on the surface; x, y: from its tile's centre.
template <typename F>
void for_each_texel(const ChartRaster& raster, int tiles_across, F&& f) {
  for (int y = 0; y < raster.height; ++y)
    for (int x = 0; x < raster.width; ++x) {
      const auto at =
          static_cast<std::size_t>(y) * static_cast<std::size_t>(raster.width) + static_cast<std::size_t>(x);
      const auto raw = static_cast<std::uint16_t>(raster.raw[at] & ~ChartRaster::kCore);
      if (raw)
        f(static_cast<std::size_t>(y / atlas::kTile * tiles_across + x / atlas::kTile), x % atlas::kTile - kCenter,
          y % atlas::kTile - kCenter, raw);
    }
}

/// True where some edge of the triangle (texels) has the square around `at` on its outer side.
bool apart(const std::array<Vector2d, 3>& corners, double turn, const Vector2d& at, double half) {
  for (std::size_t i = 0; i < 3; ++i) {
    const Vector2d along = corners[(i + 1) % 3] - corners[i], to = at - corners[i];
    const double inside = turn * (along.x() * to.y() - along.y() * to.x());
    if (inside + half * along.cwiseAbs().sum() < 0) return true;
  }
  return false;
}

}  // namespace

std::vector<TilePlane> find_tile_planes(const SurfacePatches& surface, int index, const ChartRaster& raster) {
  const Chart& chart = surface.charts[static_cast<std::size_t>(index)];
  const Patch& patch = surface.patches[static_cast<std::size_t>(chart.patch)];
  const Eigen::Array2i tiles((raster.width + atlas::kTile - 1) / atlas::kTile,
                             (raster.height + atlas::kTile - 1) / atlas::kTile);
  std::vector<Bounds> bounds(static_cast<std::size_t>(tiles.prod()));
  for (std::uint32_t t : chart.triangles) {
    std::array<Vector2d, 3> at;  // texels
    std::array<double, 3> h{};
    for (std::size_t i = 0; i < 3; ++i) {
      const Vector3d p = surface.corners[t][i] - patch.origin;
      at[i] = (Vector2d(p.dot(patch.eu), p.dot(patch.ev)) - raster.uv0).cwiseProduct(raster.density);
      h[i] = p.dot(patch.n);
    }
    const Vector2d a = at[1] - at[0], b = at[2] - at[0];
    const double area = a.x() * b.y() - a.y() * b.x();
    if (std::abs(area) < 1e-9) continue;  // seen edge on: its texels lie on its neighbours too
    const Vector2d step(((h[1] - h[0]) * b.y() - (h[2] - h[0]) * a.y()) / area,
                        ((h[2] - h[0]) * a.x() - (h[1] - h[0]) * b.x()) / area);  // metres per texel
    const Vector2d low = at[0].cwiseMin(at[1]).cwiseMin(at[2]), high = at[0].cwiseMax(at[1]).cwiseMax(at[2]);
    const Eigen::Array2i from = ((low.array() - kGuardReach) / atlas::kTile).floor().cast<int>().max(0).min(tiles - 1);
    const Eigen::Array2i to = ((high.array() + kGuardReach) / atlas::kTile).floor().cast<int>().max(0).min(tiles - 1);
    for (int y = from.y(); y <= to.y(); ++y)
      for (int x = from.x(); x <= to.x(); ++x) {
        const Vector2d middle = atlas::kTile * Vector2d(x, y) + Vector2d::Constant(kCenter);
        if (apart(at, area > 0 ? 1 : -1, middle, kHalfTile + kGuardReach)) continue;
        Bounds& tile = bounds[static_cast<std::size_t>(y * tiles.x() + x)];
        tile.center.include(h[0] + step.dot(middle - at[0]));
        tile.slope_u.include(step.x() * raster.density.x());
        tile.slope_v.include(step.y() * raster.density.y());
      }
  }
  std::vector<TilePlane> out(bounds.size());
  for_each_texel(raster, tiles.x(), [&](std::size_t tile, double, double, std::uint16_t raw) {
    out[tile].low = out[tile].low ? std::min(out[tile].low, raw) : raw;
    out[tile].high = std::max(out[tile].high, raw);
  });
  for (std::size_t i = 0; i < bounds.size(); ++i) {
    const Bounds& tile = bounds[i];
    if (tile.center.low > tile.center.high || !out[i].high) continue;
    TilePlane& plane = out[i];
    plane.slope = Vector2d(tile.slope_u.middle(), tile.slope_v.middle()).cast<float>();
    plane.spread = Vector2d(tile.slope_u.half(), tile.slope_v.half()).cast<float>();
    plane.center = static_cast<float>(1 + (tile.center.middle() - raster.height0) / raster.height_step);
    plane.offset = static_cast<float>(tile.center.half() / raster.height_step);
    plane.residual = 0;
  }
  // Texels of the guard band, and those of triangles smaller than a texel, lie beside the planes of
  // the triangles: only they themselves tell how far.
  for_each_texel(raster, tiles.x(), [&](std::size_t tile, double x, double y, std::uint16_t raw) {
    TilePlane& plane = out[tile];
    const Vector2d step = plane.slope.cast<double>().cwiseQuotient(raster.density) / raster.height_step;
    const double off = std::abs(raw - static_cast<double>(plane.center) - step.dot(Vector2d(x, y)));
    plane.residual = std::max(plane.residual, static_cast<float>(off));
  });
  return out;
}

bool faces_away(const TilePlane& tile, const ChartRaster& raster, const Vector2d& uv, const Vector3d& eye) {
  constexpr double kRounding = 1e-4;  // metres
  if (tile.residual < 0) return true;
  const double height = raster.height0 + (static_cast<double>(tile.center) - 1) * raster.height_step;
  const Vector3d s = eye - Vector3d(uv.x(), uv.y(), height);
  // A triangle's normal is (-slope, 1); its plane passes the tile's centre at up to `offset`.
  const Vector2d slope = tile.slope.cast<double>(), spread = tile.spread.cast<double>();
  const double facing = s.z() - slope.dot(s.head<2>()) + spread.dot(s.head<2>().cwiseAbs());
  const double slack = static_cast<double>(tile.offset) * raster.height_step + kRounding;
  return facing + slack < 0;
}

std::array<std::uint32_t, 2> packed(const TilePlane& tile, const ChartRaster& raster) {
  const auto half2 = [](double a, double b) {
    const Eigen::half x(static_cast<float>(a)), y(static_cast<float>(b));
    return static_cast<std::uint32_t>(x.x) | static_cast<std::uint32_t>(y.x) << 16;
  };
  if (tile.residual < 0) return {half2(0, -1), 0};
  const double half_range = (tile.high - tile.low) / 2.0;
  constexpr double kLargest = 30000;                         // far below what half floats hold
  const bool extreme = !(std::abs(tile.center) < kLargest);  // a triangle smaller than a texel, extended over the tile
  if (half_range <= tile.residual || extreme) return {half2((tile.low + tile.high) / 2.0, half_range * 1.001 + 17), 0};
  const Eigen::Vector2d step =
      tile.slope.cast<double>().cwiseQuotient(raster.density) / std::max(raster.height_step, 1e-12);
  // Half floats keep eleven bits: the residual makes up for what the others lose.
  const double lost = (std::abs(tile.center) + 2 * kHalfTile * step.cwiseAbs().sum()) / 2048;
  return {half2(tile.center, tile.residual * 1.001 + lost + 1), half2(step.x(), step.y())};
}

}  // namespace foresight

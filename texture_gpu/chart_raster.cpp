#include "texture_gpu/chart_raster.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace foresight {
namespace {

using Eigen::Vector2d;

constexpr double kGuard = 1.5;  // texels between the chart's rectangle and its outermost texel centre
constexpr float kNone = std::numeric_limits<float>::quiet_NaN();

struct Grid {
  int width, height;
  std::vector<float> h;  // metres along n; NaN: no surface
  float& at(int x, int y) {
    return h[static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x)];
  }
};

struct Corner {
  double x, y, h;  // texels, texels, metres
};

/// Calls f(x, y, h) for each texel centre inside the triangle, h: the triangle's height there.
template <typename F>
void for_texels_inside(const std::array<Corner, 3>& c, int width, int height, F&& f) {
  const double area = (c[1].x - c[0].x) * (c[2].y - c[0].y) - (c[1].y - c[0].y) * (c[2].x - c[0].x);
  if (std::abs(area) <= 1e-9) return;
  const auto [min_x, max_x] = std::minmax({c[0].x, c[1].x, c[2].x});
  const auto [min_y, max_y] = std::minmax({c[0].y, c[1].y, c[2].y});
  const int x0 = std::max(0, static_cast<int>(std::ceil(std::max(min_x, -1.0))));
  const int x1 = std::min(width - 1, static_cast<int>(std::floor(std::min(max_x, 1e6))));
  const int y0 = std::max(0, static_cast<int>(std::ceil(std::max(min_y, -1.0))));
  const int y1 = std::min(height - 1, static_cast<int>(std::floor(std::min(max_y, 1e6))));
  const double b1x = (c[2].y - c[0].y) / area, b1y = -(c[2].x - c[0].x) / area;
  const double b2x = -(c[1].y - c[0].y) / area, b2y = (c[1].x - c[0].x) / area;
  constexpr double kEdge = -1e-6;
  for (int y = y0; y <= y1; ++y) {
    for (int x = x0; x <= x1; ++x) {
      const double dx = x - c[0].x, dy = y - c[0].y;
      const double b1 = b1x * dx + b1y * dy, b2 = b2x * dx + b2y * dy;
      if (b1 < kEdge || b2 < kEdge || b1 + b2 > 1 - kEdge) continue;
      f(x, y, c[0].h + b1 * (c[1].h - c[0].h) + b2 * (c[2].h - c[0].h));
    }
  }
}

/// Heights at the texel centres inside the triangle, and at the texels nearest to its corners, so
/// that triangles smaller than a texel are not lost.
void draw(Grid& grid, const std::array<Corner, 3>& c) {
  for_texels_inside(c, grid.width, grid.height, [&](int x, int y, double h) { grid.at(x, y) = static_cast<float>(h); });
  for (const Corner& corner : c) {
    const double x = std::round(corner.x), y = std::round(corner.y);
    if (x < 0 || y < 0 || x >= grid.width || y >= grid.height) continue;
    float& h = grid.at(static_cast<int>(x), static_cast<int>(y));
    if (std::isnan(h)) h = static_cast<float>(corner.h);
  }
}

/// The corners of a scene triangle in the texels of a raster.
std::array<Corner, 3> corners_in_texels(const SurfacePatches& surface, const Patch& patch, std::uint32_t triangle,
                                        const ChartRaster& raster) {
  std::array<Corner, 3> corners;
  for (std::size_t i = 0; i < 3; ++i) {
    const Eigen::Vector3d p = surface.corners[triangle][i] - patch.origin;
    corners[i] = {(p.dot(patch.eu) - raster.uv0.x()) * raster.density.x(),
                  (p.dot(patch.ev) - raster.uv0.y()) * raster.density.y(), p.dot(patch.n)};
  }
  return corners;
}

/// One ring of texels around the surface, each at the mean height of its neighbours.
void grow_guard(Grid& grid) {
  const std::vector<float> before = grid.h;
  const auto old = [&](int x, int y) {
    if (x < 0 || y < 0 || x >= grid.width || y >= grid.height) return kNone;
    return before[static_cast<std::size_t>(y) * static_cast<std::size_t>(grid.width) + static_cast<std::size_t>(x)];
  };
  for (int y = 0; y < grid.height; ++y) {
    for (int x = 0; x < grid.width; ++x) {
      if (!std::isnan(old(x, y))) continue;
      float sum = 0;
      int count = 0;
      for (int dy = -1; dy <= 1; ++dy)
        for (int dx = -1; dx <= 1; ++dx)
          if (const float h = old(x + dx, y + dy); !std::isnan(h)) sum += h, ++count;
      if (count) grid.at(x, y) = sum / static_cast<float>(count);
    }
  }
}

}  // namespace

Eigen::Vector2i chart_size(const Chart& chart, const Vector2d& density) {
  const Vector2d extent = (chart.upper - chart.lower).cwiseProduct(density);
  return {static_cast<int>(std::ceil(extent.x() + 2 * kGuard)) + 1,
          static_cast<int>(std::ceil(extent.y() + 2 * kGuard)) + 1};
}

ChartRaster raster_chart(const SurfacePatches& surface, int index, const Vector2d& density) {
  const Chart& chart = surface.charts[static_cast<std::size_t>(index)];
  const Patch& patch = surface.patches[static_cast<std::size_t>(chart.patch)];
  const Eigen::Vector2i size = chart_size(chart, density);
  ChartRaster out;
  out.density = density;
  out.width = size.x();
  out.height = size.y();
  out.uv0 = chart.lower - kGuard * density.cwiseInverse();

  Grid grid{out.width, out.height,
            std::vector<float>(static_cast<std::size_t>(out.width) * static_cast<std::size_t>(out.height), kNone)};
  for (std::uint32_t t : chart.triangles) draw(grid, corners_in_texels(surface, patch, t, out));
  const std::vector<float> core = grid.h;
  grow_guard(grid);

  float low = std::numeric_limits<float>::max(), high = -low;
  for (float h : grid.h)
    if (!std::isnan(h)) low = std::min(low, h), high = std::max(high, h);
  out.raw.assign(grid.h.size(), 0);
  if (low > high) return out;
  constexpr double kLevels = 32766;
  out.height0 = low;
  out.height_step = std::max(1e-9, (static_cast<double>(high) - low) / kLevels);
  for (std::size_t i = 0; i < grid.h.size(); ++i)
    if (!std::isnan(grid.h[i]))
      out.raw[i] =
          static_cast<std::uint16_t>((1 + std::lround((static_cast<double>(grid.h[i]) - low) / out.height_step)) |
                                     (std::isnan(core[i]) ? 0 : ChartRaster::kCore));
  return out;
}

std::vector<int> triangles_under(const SurfacePatches& surface, int index, const ChartRaster& raster) {
  const Chart& chart = surface.charts[static_cast<std::size_t>(index)];
  const Patch& patch = surface.patches[static_cast<std::size_t>(chart.patch)];
  std::vector<int> out(raster.raw.size(), -1);
  // In the order of raster_chart(): on an edge the later triangle has the last word, there and here.
  for (std::uint32_t t : chart.triangles)
    for_texels_inside(
        corners_in_texels(surface, patch, t, raster), raster.width, raster.height, [&](int x, int y, double) {
          out[static_cast<std::size_t>(y) * static_cast<std::size_t>(raster.width) + static_cast<std::size_t>(x)] =
              static_cast<int>(t);
        });
  return out;
}

}  // namespace foresight

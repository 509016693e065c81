// Bounds of tiles against all texels and all triangles on them.
#include "texture_gpu/tile_planes.hpp"

#include <gtest/gtest.h>

#include <cstring>
#include <random>

#include "scene/primitives.hpp"
#include "tests/support/small_scene.hpp"
#include "texture_gpu/atlas_layout.hpp"

namespace foresight::tile_planes_test {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

/// A hilly rectangle of random triangles.
Mesh hills(unsigned seed, double size, int steps, double rise) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> shift(-0.3, 0.3), height(0, rise);
  Mesh mesh;
  for (int y = 0; y <= steps; ++y)
    for (int x = 0; x <= steps; ++x)
      mesh.vertices.push_back(
          Vector3d(size * (x + shift(random)) / steps, size * (y + shift(random)) / steps, height(random))
              .cast<float>());
  const auto at = [&](int x, int y) { return static_cast<std::uint32_t>(y * (steps + 1) + x); };
  for (int y = 0; y < steps; ++y)
    for (int x = 0; x < steps; ++x) {
      mesh.triangles.push_back({at(x, y), at(x + 1, y), at(x + 1, y + 1)});
      mesh.triangles.push_back({at(x, y), at(x + 1, y + 1), at(x, y + 1)});
    }
  return mesh;
}

SceneModel many_shapes() {
  const Pose I = Pose::Identity();
  return SceneModel({{"box", make_box({0.3, 0.2, 0.1}), -1, I},
                     {"sphere", make_sphere(0.2), -1, I},
                     {"cylinder", make_cylinder(0.05, 0.4), -1, I},
                     {"hills", hills(1, 0.5, 12, 0.03), -1, I},
                     {"crags", hills(2, 0.2, 9, 0.06), -1, I}});
}

struct Tile {
  TilePlane plane;
  int x = 0, y = 0;  // first texel
};

class TilePlanes : public testing::TestWithParam<Vector2d> {
 protected:
  /// Calls f(chart, raster, tile) for all tiles of all charts at the density of the parameter.
  template <typename F>
  void for_each_tile(F&& f) const {
    for (std::size_t i = 0; i < surface_.charts.size(); ++i) {
      if (surface_.charts[i].radius == 0) continue;
      const ChartRaster raster = raster_chart(surface_, static_cast<int>(i), GetParam());
      const auto planes = find_tile_planes(surface_, static_cast<int>(i), raster);
      const int across = (raster.width + 7) / 8, down = (raster.height + 7) / 8;
      ASSERT_EQ(planes.size(), static_cast<std::size_t>(across * down));
      for (std::size_t t = 0; t < planes.size(); ++t)
        f(i, raster, Tile{planes[t], 8 * (static_cast<int>(t) % across), 8 * (static_cast<int>(t) / across)});
    }
  }

  template <typename F>
  static void for_each_texel(const ChartRaster& raster, const Tile& tile, F&& f) {
    for (int y = tile.y; y < std::min(raster.height, tile.y + 8); ++y)
      for (int x = tile.x; x < std::min(raster.width, tile.x + 8); ++x)
        if (const int raw = raster.raw[static_cast<std::size_t>(y * raster.width + x)] & ~ChartRaster::kCore)
          f(x - tile.x - 3.5, y - tile.y - 3.5, raw);
  }

  SceneModel scene_ = many_shapes();
  SurfacePatches surface_ = find_surface_patches(scene_, {});
};

TEST_P(TilePlanes, BoundTheHeightOfEveryTexel) {
  int tiles = 0, texels = 0, sloped = 0, outside = 0;
  for_each_tile([&](std::size_t, const ChartRaster& raster, const Tile& tile) {
    int low = 0x10000, high = 0;
    const Vector2d step = tile.plane.slope.cast<double>().cwiseQuotient(raster.density) / raster.height_step;
    for_each_texel(raster, tile, [&](double x, double y, int raw) {
      low = std::min(low, raw), high = std::max(high, raw);
      ++texels;
      outside += std::abs(raw - tile.plane.center - step.dot(Vector2d(x, y))) > tile.plane.residual * 1.0001 + 0.01;
    });
    ASSERT_EQ(tile.plane.high, high);
    ASSERT_EQ(tile.plane.low, high ? low : 0);
    ASSERT_EQ(tile.plane.residual >= 0, high > 0) << "a surface exactly where there are texels";
    ++tiles;
    sloped += tile.plane.slope.norm() > 0.2f;
  });
  EXPECT_EQ(outside, 0);
  EXPECT_GT(tiles, 300);
  EXPECT_GT(texels, 5000);
  EXPECT_GT(sloped, 20);
}

Vector2d unpack_half2(std::uint32_t v) {
  const auto half = [](std::uint32_t bits) {
    return static_cast<double>(
        static_cast<float>(Eigen::half(Eigen::half_impl::raw_uint16_to_half(static_cast<std::uint16_t>(bits)))));
  };
  return {half(v & 0xffff), half(v >> 16)};
}

TEST_P(TilePlanes, StillBoundThemAsHalfFloats) {
  int outside = 0;
  double slack = 0, range = 0;
  for_each_tile([&](std::size_t chart, const ChartRaster& raster, const Tile& tile) {
    const auto words = packed(tile.plane, raster);
    const Vector2d center_residual = unpack_half2(words[0]), step = unpack_half2(words[1]);
    ASSERT_TRUE(center_residual.allFinite() && step.allFinite()) << "chart " << chart;
    ASSERT_EQ(center_residual.y() >= 0, tile.plane.residual >= 0);
    for_each_texel(raster, tile, [&](double x, double y, int raw) {
      outside += std::abs(raw - center_residual.x() - step.dot(Vector2d(x, y))) > center_residual.y();
    });
    const int node = surface_.patches[static_cast<std::size_t>(surface_.charts[chart].patch)].node;
    if (tile.plane.residual < 0 || node > 2) return;  // on hills as rough as these no plane is better than a range
    slack += center_residual.y() * raster.height_step;
    range += (tile.plane.high - tile.plane.low) / 2.0 * raster.height_step;
  });
  EXPECT_EQ(outside, 0);
  // Planes are there to be closer than the range of heights, where tiles are not larger than charts.
  if (GetParam().x() > 300) {
    EXPECT_LT(slack, 0.7 * range);
  }
}

/// True where the triangle and the square from `low` to `high` overlap (separating axes).
bool overlap(const std::array<Vector2d, 3>& t, const Vector2d& low, const Vector2d& high) {
  const std::array<Vector2d, 4> square{low, {high.x(), low.y()}, high, {low.x(), high.y()}};
  std::vector<Vector2d> axes{{1, 0}, {0, 1}};
  for (std::size_t i = 0; i < 3; ++i) axes.push_back((t[(i + 1) % 3] - t[i]).unitOrthogonal());
  for (const Vector2d& axis : axes) {
    double a = 1e30, b = -1e30, c = 1e30, d = -1e30;
    for (const Vector2d& p : t) a = std::min(a, axis.dot(p)), b = std::max(b, axis.dot(p));
    for (const Vector2d& p : square) c = std::min(c, axis.dot(p)), d = std::max(d, axis.dot(p));
    if (a > d || c > b) return false;
  }
  return true;
}

TEST_P(TilePlanes, NeverFaceAwayWhereATriangleFacesTheEye) {
  std::mt19937 random(5);
  std::normal_distribution<double> normal;
  int away = 0, could = 0;
  for_each_tile([&](std::size_t index, const ChartRaster& raster, const Tile& tile) {
    const Chart& chart = surface_.charts[index];
    const Patch& patch = surface_.patches[static_cast<std::size_t>(chart.patch)];
    const Vector2d uv = raster.uv0 + Vector2d(tile.x + 3.5, tile.y + 3.5).cwiseQuotient(raster.density);
    for (int k = 0; k < 12; ++k) {
      // From far to within the shape.
      const Vector3d eye =
          chart.center + Vector3d(normal(random), normal(random), normal(random)) * (k % 3 == 0   ? 1.0
                                                                                     : k % 3 == 1 ? 0.2
                                                                                                  : 0.03);
      const Vector3d s = eye - patch.origin;
      const bool answer = faces_away(tile.plane, raster, uv, {s.dot(patch.eu), s.dot(patch.ev), s.dot(patch.n)});
      bool any_faces = false;
      for (const std::uint32_t t : chart.triangles) {
        const auto& p = surface_.corners[t];
        if ((p[1] - p[0]).cross(p[2] - p[0]).normalized().dot(eye - p[0]) < 1e-6) continue;
        std::array<Vector2d, 3> at;
        for (std::size_t i = 0; i < 3; ++i)
          at[i] = (Vector2d((p[i] - patch.origin).dot(patch.eu), (p[i] - patch.origin).dot(patch.ev)) - raster.uv0)
                      .cwiseProduct(raster.density);
        // Half a texel around the outermost centres.
        any_faces =
            any_faces || overlap(at, Vector2d(tile.x - 0.5, tile.y - 0.5), Vector2d(tile.x + 7.5, tile.y + 7.5));
      }
      ASSERT_FALSE(answer && any_faces && tile.plane.residual >= 0) << "chart " << index;
      if (tile.plane.residual < 0) continue;
      away += answer;
      could += !any_faces;
    }
  });
  // Not idle: most of what faces away is found.
  EXPECT_GT(away, GetParam().x() > 100 ? could * 3 / 4 : could / 3);
}

INSTANTIATE_TEST_SUITE_P(Densities, TilePlanes,
                         testing::Values(Vector2d(400, 400), Vector2d(150, 60), Vector2d(20, 30), Vector2d(3, 2)),
                         [](const auto& i) { return std::to_string(static_cast<int>(i.param.x())); });

TEST(TilePlane, TheBacksOfABoxFaceAway) {
  const SceneModel scene({{"box", make_box({0.3, 0.2, 0.1}), -1, Pose::Identity()}});
  const SurfacePatches surface = find_surface_patches(scene, {});
  const Vector3d eye(1, 0.8, 0.6);  // sees three faces
  int front = 0, back = 0;
  for (std::size_t i = 0; i < surface.charts.size(); ++i) {
    if (surface.charts[i].radius == 0) continue;
    const Patch& patch = surface.patches[static_cast<std::size_t>(surface.charts[i].patch)];
    const ChartRaster raster = raster_chart(surface, static_cast<int>(i), {200, 200});
    const auto planes = find_tile_planes(surface, static_cast<int>(i), raster);
    const int across = (raster.width + 7) / 8;
    const Vector3d s = eye - patch.origin, local(s.dot(patch.eu), s.dot(patch.ev), s.dot(patch.n));
    for (int t = 0; t < static_cast<int>(planes.size()); ++t) {
      if (planes[static_cast<std::size_t>(t)].residual < 0) continue;
      const Vector2d uv = raster.uv0 + Vector2d(8 * (t % across) + 3.5, 8 * (t / across) + 3.5) / 200;
      const bool away = faces_away(planes[static_cast<std::size_t>(t)], raster, uv, local);
      EXPECT_EQ(away, local.z() < 0);
      (away ? back : front) += 1;
    }
  }
  EXPECT_GT(front, 50);
  EXPECT_EQ(front, back) << "opposite faces have as many tiles";
}

}  // namespace
}  // namespace foresight::tile_planes_test

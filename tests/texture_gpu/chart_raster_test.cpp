#include "texture_gpu/chart_raster.hpp"

#include <gtest/gtest.h>

#include "scene/primitives.hpp"
#include "tests/support/small_scene.hpp"

namespace foresight::chart_raster_test {
namespace {

bool is_core(std::uint16_t raw) {
  return (raw & ChartRaster::kCore) != 0;
}

TEST(ChartRaster, HasTheSizeThatWasAnnounced) {
  const SurfacePatches surface = find_surface_patches(*small_scene(), {});
  for (std::size_t i = 0; i < surface.charts.size(); ++i) {
    if (surface.charts[i].radius == 0) continue;
    for (const Eigen::Vector2d& density : {Eigen::Vector2d(90, 90), Eigen::Vector2d(33, 210)}) {
      const ChartRaster r = raster_chart(surface, static_cast<int>(i), density);
      EXPECT_EQ(Eigen::Vector2i(r.width, r.height), chart_size(surface.charts[i], density));
      EXPECT_EQ(r.raw.size(), static_cast<std::size_t>(r.width) * static_cast<std::size_t>(r.height));
    }
  }
}

// A rectangle of 0.5 x 0.4 m at 40 x 60 texels per metre: 21 x 25 texel centres fall inside when the
// first lies 1.5 texels before the edge. What is inside is marked, the ring around is guard.
TEST(ChartRaster, MarksTheInsideAndSurroundsItWithGuards) {
  const SurfacePatches surface = find_surface_patches(*plane_scene(0.5, 0.4), {60, 10});
  ASSERT_EQ(surface.charts.size(), 1u);
  const Patch& patch = surface.patches[0];
  const ChartRaster r = raster_chart(surface, 0, {40, 60});
  int core = 0, guard = 0;
  for (int y = 0; y < r.height; ++y)
    for (int x = 0; x < r.width; ++x) {
      const std::uint16_t raw = r.raw[static_cast<std::size_t>(y * r.width + x)];
      const Eigen::Vector2d uv = r.uv0 + Eigen::Vector2d(x, y).cwiseQuotient(r.density);
      const bool inside = (uv.array() > 1e-9).all() && ((patch.size - uv).array() > 1e-9).all();
      core += is_core(raw);
      guard += raw != 0 && !is_core(raw);
      // Texels nearest to a corner count as inside too.
      if (inside) {
        EXPECT_TRUE(is_core(raw)) << x << ", " << y;
      }
      // Every texel that bilinear filtering of an inner point may touch has a height.
      const bool touched =
          (uv.array() > -1 / r.density.array()).all() && ((patch.size - uv).array() > -1 / r.density.array()).all();
      if (touched) {
        EXPECT_NE(raw, 0) << x << ", " << y;
      }
    }
  const Eigen::Vector2d texels = patch.size.cwiseProduct(r.density);
  EXPECT_NEAR(core, texels.prod(), texels.sum() + 4);
  EXPECT_GT(guard, 2 * texels.sum());
}

TEST(ChartRaster, HeightsLieOnTheTriangles) {
  const auto scene = SceneModel({{"sphere", make_sphere(0.5), -1, Pose::Identity()}});
  const SurfacePatches surface = find_surface_patches(scene, {60, 0.3});
  double worst = 0;
  int texels = 0;
  for (std::size_t i = 0; i < surface.charts.size(); ++i) {
    if (surface.charts[i].radius == 0) continue;
    const Patch& patch = surface.patches[static_cast<std::size_t>(surface.charts[i].patch)];
    const ChartRaster r = raster_chart(surface, static_cast<int>(i), {150, 150});
    for (int y = 0; y < r.height; ++y)
      for (int x = 0; x < r.width; ++x) {
        const std::uint16_t raw = r.raw[static_cast<std::size_t>(y * r.width + x)];
        if (!is_core(raw)) continue;
        const Eigen::Vector2d uv = r.uv0 + Eigen::Vector2d(x, y) / 150;
        const Eigen::Vector3d p = patch.origin + uv.x() * patch.eu + uv.y() * patch.ev +
                                  (r.height0 + ((raw & 0x7fff) - 1) * r.height_step) * patch.n;
        // 32 facets around keep within 1 - cos(pi / 32) of the ball, 16 from pole to pole likewise.
        worst = std::max(worst, std::abs(p.norm() - 0.5));
        ++texels;
      }
  }
  EXPECT_GT(texels, 30000);
  EXPECT_LT(worst, 0.5 * 0.013 + 0.005) << "corner texels lie up to half a texel's slope beside the surface";
}

TEST(ChartRaster, TrianglesSmallerThanATexelAreNotLost) {
  const SurfacePatches surface =
      find_surface_patches(SceneModel({{"ball", make_sphere(0.01), -1, Pose::Identity()}}), {});
  for (std::size_t i = 0; i < surface.charts.size(); ++i) {
    if (surface.charts[i].radius == 0) continue;
    const ChartRaster r = raster_chart(surface, static_cast<int>(i), {5, 5});
    EXPECT_TRUE(std::any_of(r.raw.begin(), r.raw.end(), is_core)) << i;
  }
}

}  // namespace
}  // namespace foresight::chart_raster_test

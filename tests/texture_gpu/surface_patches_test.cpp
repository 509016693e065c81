#include "texture_gpu/surface_patches.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "scene/primitives.hpp"
#include "tests/support/small_scene.hpp"
#include "texture_gpu/chart_raster.hpp"

namespace foresight::surface_patches_test {
namespace {

SceneModel one_node(Mesh mesh) {
  return SceneModel({{"node", std::move(mesh), -1, Pose::Identity()}});
}

/// A ramp that winds `turns` times around z and rises `rise` metres a turn: seen from above it hides itself.
Mesh spiral_ramp(double turns, double rise) {
  Mesh mesh;
  constexpr int kSteps = 24;  // a turn
  const int count = static_cast<int>(turns * kSteps);
  for (int i = 0; i <= count; ++i) {
    const double angle = 2 * M_PI * i / kSteps, z = rise * i / kSteps;
    for (double r : {0.3, 0.6})
      mesh.vertices.push_back(Eigen::Vector3d(r * std::cos(angle), r * std::sin(angle), z).cast<float>());
  }
  for (std::uint32_t i = 0; i < static_cast<std::uint32_t>(count); ++i) {
    mesh.triangles.push_back({2 * i, 2 * i + 1, 2 * i + 3});
    mesh.triangles.push_back({2 * i, 2 * i + 3, 2 * i + 2});
  }
  return mesh;
}

/// A gently rolling surface of n x n squares over one square metre.
Mesh hills(int n) {
  Mesh mesh;
  for (int y = 0; y <= n; ++y)
    for (int x = 0; x <= n; ++x) {
      const double u = static_cast<double>(x) / n, v = static_cast<double>(y) / n;
      mesh.vertices.push_back(Eigen::Vector3d(u, v, 0.08 * std::sin(7 * u) * std::cos(5 * v)).cast<float>());
    }
  const auto at = [&](int x, int y) { return static_cast<std::uint32_t>(y * (n + 1) + x); };
  for (int y = 0; y < n; ++y)
    for (int x = 0; x < n; ++x) {
      mesh.triangles.push_back({at(x, y), at(x + 1, y), at(x + 1, y + 1)});
      mesh.triangles.push_back({at(x, y), at(x + 1, y + 1), at(x, y + 1)});
    }
  return mesh;
}

struct Named {
  std::string name;
  SceneModel scene;
};

const std::vector<Named>& scenes() {
  static const std::vector<Named> all{{"small scene", *small_scene()},
                                      {"sphere", one_node(make_sphere(0.4))},
                                      {"cylinder", one_node(make_cylinder(0.2, 0.7))},
                                      {"hills", one_node(hills(24))},
                                      {"spiral", one_node(spiral_ramp(2.5, 0.3))}};
  return all;
}

TEST(SurfacePatches, HaveEveryTriangleExactlyOnce) {
  for (const auto& [name, scene] : scenes()) {
    const SurfacePatches surface = find_surface_patches(scene, {});
    ASSERT_EQ(surface.patch_of_triangle.size(), scene.triangle_count()) << name;
    ASSERT_EQ(surface.corners.size(), scene.triangle_count()) << name;
    for (std::size_t t = 0; t < scene.triangle_count(); ++t) {
      const int patch = surface.patch_of_triangle[t];
      ASSERT_GE(patch, 0) << name;
      ASSERT_LT(patch, static_cast<int>(surface.patches.size())) << name;
      // Charts list it only in its own patch, and at least one does.
      std::size_t charts = 0;
      for (const Chart& chart : surface.charts) {
        if (std::find(chart.triangles.begin(), chart.triangles.end(), t) == chart.triangles.end()) continue;
        ASSERT_EQ(chart.patch, patch) << name;
        ++charts;
      }
      ASSERT_GE(charts, 1u) << name << ", triangle " << t;
    }
  }
}

TEST(SurfacePatches, HaveOrthonormalFramesAndCoverTheirTriangles) {
  for (const auto& [name, scene] : scenes()) {
    const SurfacePatches surface = find_surface_patches(scene, {});
    for (const Patch& p : surface.patches) {
      EXPECT_NEAR(p.eu.cross(p.ev).dot(p.n), 1, 1e-9) << name;
      EXPECT_NEAR(std::abs(p.eu.dot(p.ev)) + std::abs(p.eu.dot(p.n)), 0, 1e-9) << name;
    }
    for (std::size_t t = 0; t < surface.corners.size(); ++t) {
      const Patch& p = surface.patches[static_cast<std::size_t>(surface.patch_of_triangle[t])];
      for (const Eigen::Vector3d& corner : surface.corners[t]) {
        const Eigen::Vector2d uv((corner - p.origin).dot(p.eu), (corner - p.origin).dot(p.ev));
        EXPECT_GE(uv.minCoeff(), -1e-9) << name;
        EXPECT_LE((uv - p.size).maxCoeff(), 1e-9) << name;
      }
    }
  }
}

// The heart of the charts: a point of the surface goes to (u, v) of its patch and comes back from
// the height that is stored there. A patch that hides part of itself would give another height.
TEST(SurfacePatches, PointsComeBackFromTheirPlaceAndHeight) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> unit(0, 1);
  for (const auto& [name, scene] : scenes()) {
    const SurfacePatches surface = find_surface_patches(scene, {});
    constexpr double kDensity = 250;  // texels per metre
    std::vector<ChartRaster> rasters;
    for (std::size_t i = 0; i < surface.charts.size(); ++i)
      rasters.push_back(surface.charts[i].radius > 0 ? raster_chart(surface, static_cast<int>(i), {kDensity, kDensity})
                                                     : ChartRaster{});
    int beyond = 0, points = 0;
    for (std::size_t t = 0; t < surface.corners.size(); ++t) {
      const Patch& patch = surface.patches[static_cast<std::size_t>(surface.patch_of_triangle[t])];
      const auto& c = surface.corners[t];
      const Eigen::Vector3d normal = (c[1] - c[0]).cross(c[2] - c[0]).normalized();
      for (int i = 0; i < 20; ++i) {
        double a = unit(random), b = unit(random);
        if (a + b > 1) a = 1 - a, b = 1 - b;
        const Eigen::Vector3d p = c[0] + a * (c[1] - c[0]) + b * (c[2] - c[0]);
        const Eigen::Vector2d uv((p - patch.origin).dot(patch.eu), (p - patch.origin).dot(patch.ev));
        const Eigen::Array2i cell =
            (uv.array() / patch.cell_size().array()).floor().cast<int>().max(0).min(patch.cells.array() - 1);
        const ChartRaster& r =
            rasters[static_cast<std::size_t>(patch.first_chart + cell.y() * patch.cells.x() + cell.x())];
        ASSERT_GT(r.width, 0) << name << ": a point lies over an empty cell";
        const Eigen::Array2i texel = ((uv - r.uv0) * kDensity).array().round().cast<int>();
        ASSERT_TRUE((texel >= 0).all() && texel.x() < r.width && texel.y() < r.height) << name;
        const std::uint16_t raw = r.raw[static_cast<std::size_t>(texel.y() * r.width + texel.x())];
        ASSERT_NE(raw, 0) << name << ": the guard band has a gap";
        const Eigen::Vector2d at = r.uv0 + texel.matrix().cast<double>() / kDensity;
        const Eigen::Vector3d back = patch.origin + at.x() * patch.eu + at.y() * patch.ev +
                                     (r.height0 + ((raw & 0x7fff) - 1) * r.height_step) * patch.n;
        // In the triangle's plane up to the step in (u, v): distance to the plane, then along it.
        ++points;
        if (std::abs((back - p).dot(normal)) > 0.5 / kDensity) ++beyond;
      }
    }
    // Next to a crease the texel's centre lies on the other side of it: those few are off by the bend.
    EXPECT_LE(beyond, points / 50) << name << ": " << points << " points";
  }
}

TEST(SurfacePatches, NoPatchHidesItself) {
  for (const auto& [name, scene] : scenes()) {
    const SurfacePatches surface = find_surface_patches(scene, {});
    for (std::size_t t = 0; t < surface.corners.size(); ++t) {
      const Patch& patch = surface.patches[static_cast<std::size_t>(surface.patch_of_triangle[t])];
      const auto& c = surface.corners[t];
      const Eigen::Vector3d center = (c[0] + c[1] + c[2]) / 3;
      EXPECT_GT((c[1] - c[0]).cross(c[2] - c[0]).normalized().dot(patch.n), 0.3) << name << ": stretched";
      for (std::size_t s = 0; s < surface.corners.size(); ++s) {
        if (s == t || surface.patch_of_triangle[s] != surface.patch_of_triangle[t]) continue;
        const auto& d = surface.corners[s];
        const Eigen::Vector3d n = (d[1] - d[0]).cross(d[2] - d[0]);
        const double lambda = (d[0] - center).dot(n) / patch.n.dot(n);
        const Eigen::Vector3d q = center + lambda * patch.n;
        const bool inside = (d[1] - d[0]).cross(q - d[0]).dot(n) > 0 && (d[2] - d[1]).cross(q - d[1]).dot(n) > 0 &&
                            (d[0] - d[2]).cross(q - d[2]).dot(n) > 0;
        // Slivers within a hundredth of the patch's size are let pass by the overlap test.
        EXPECT_FALSE(inside && std::abs(lambda) > patch.size.norm() / 100 + 1e-9)
            << name << ": triangles " << t << " and " << s;
      }
    }
  }
}

TEST(SurfacePatches, ASpiralRampIsSplit) {
  const SurfacePatches flat = find_surface_patches(one_node(spiral_ramp(0.9, 0.3)), {});
  const SurfacePatches wound = find_surface_patches(one_node(spiral_ramp(2.5, 0.3)), {});
  EXPECT_EQ(flat.patches.size(), 1u);
  EXPECT_GE(wound.patches.size(), 3u);
  EXPECT_LE(wound.patches.size(), 8u);
}

TEST(SurfacePatches, ClosedMeshesAreFlagged) {
  const auto flags = [](const SceneModel& scene) {
    int closed = 0, open = 0;
    for (const Chart& chart : find_surface_patches(scene, {}).charts)
      if (chart.radius > 0) ++(chart.closed() ? closed : open);
    return std::pair(closed > 0, open > 0);
  };
  EXPECT_EQ(flags(one_node(make_box({1, 2, 3}))), std::pair(true, false));
  EXPECT_EQ(flags(one_node(make_sphere(1))), std::pair(true, false));
  EXPECT_EQ(flags(one_node(hills(4))), std::pair(false, true));
  EXPECT_EQ(flags(*small_scene()), std::pair(true, true));
  Mesh lidless = make_box({1, 1, 1});
  lidless.triangles.pop_back();
  EXPECT_EQ(flags(one_node(lidless)), std::pair(false, true));
  Mesh inside_out = make_box({1, 1, 1});
  for (auto& t : inside_out.triangles) std::swap(t[1], t[2]);
  EXPECT_EQ(flags(one_node(inside_out)), std::pair(false, true)) << "its front would be taken for its back";
}

TEST(SurfacePatches, NeighboursAreMutual) {
  for (const auto& [name, scene] : scenes()) {
    const SurfacePatches surface = find_surface_patches(scene, {});
    for (std::size_t i = 0; i < surface.charts.size(); ++i)
      for (int n : surface.charts[i].neighbours) {
        const auto& back = surface.charts[static_cast<std::size_t>(n)].neighbours;
        EXPECT_NE(n, static_cast<int>(i)) << name;
        EXPECT_NE(std::find(back.begin(), back.end(), static_cast<int>(i)), back.end()) << name;
        EXPECT_EQ(surface.patches[static_cast<std::size_t>(surface.charts[i].patch)].node,
                  surface.patches[static_cast<std::size_t>(surface.charts[static_cast<std::size_t>(n)].patch)].node)
            << name << ": colours would be handed on between bodies";
      }
  }
}

TEST(SurfacePatches, ChartsAreNoLargerThanAskedAndBoundTheirSurface) {
  const SceneModel scene = one_node(hills(24));
  const SurfacePatches surface = find_surface_patches(scene, {60, 0.21});
  EXPECT_GE(surface.charts.size(), 25u);
  for (const Chart& chart : surface.charts) {
    if (chart.radius == 0) continue;
    EXPECT_LE((chart.upper - chart.lower).maxCoeff(), 0.21 + 1e-9);
    for (std::uint32_t t : chart.triangles) {
      const Patch& patch = surface.patches[static_cast<std::size_t>(chart.patch)];
      for (const Eigen::Vector3d& p : surface.corners[t]) {
        const Eigen::Vector2d uv((p - patch.origin).dot(patch.eu), (p - patch.origin).dot(patch.ev));
        if ((uv.array() < chart.lower.array()).any() || (uv.array() > chart.upper.array()).any()) continue;
        EXPECT_LE((p - chart.center).norm(), chart.radius + 1e-9);
      }
    }
  }
}

TEST(SurfacePatches, AreTheSameEveryTime) {
  const SurfacePatches a = find_surface_patches(scenes()[4].scene, {}), b = find_surface_patches(scenes()[4].scene, {});
  EXPECT_EQ(a.patch_of_triangle, b.patch_of_triangle);
  ASSERT_EQ(a.charts.size(), b.charts.size());
  for (std::size_t i = 0; i < a.charts.size(); ++i) EXPECT_EQ(a.charts[i].triangles, b.charts[i].triangles);
}

}  // namespace
}  // namespace foresight::surface_patches_test

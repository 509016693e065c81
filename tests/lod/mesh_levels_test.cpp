#include "scene/lod/mesh_levels.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <map>
#include <set>

#include "scene/lod/nearest_surface.hpp"
#include "scene/lod/scene_levels.hpp"
#include "scene/primitives.hpp"
#include "sim/workshop.hpp"
#include "sim/woven.hpp"

namespace foresight::mesh_levels_test {
namespace {

using Triangles = std::vector<std::array<std::uint32_t, 3>>;

Mesh ball(int across) {
  return sim::woven({across / 2, across, false, true}, [](double u, double v) -> Eigen::Vector3d {
    const double up = EIGEN_PI * (u - 0.5), around = 2 * EIGEN_PI * v;
    const double radius = u == 0 || u == 1 ? 0 : 0.5 * std::cos(up);
    return {radius * std::cos(around), radius * std::sin(around), 0.5 * std::sin(up)};
  });
}

/// Which eighth of space a triangle lies in.
std::vector<int> eighths(const Mesh& mesh) {
  std::vector<int> out;
  for (const auto& t : mesh.triangles) {
    const Eigen::Vector3f middle = mesh.vertices[t[0]] + mesh.vertices[t[1]] + mesh.vertices[t[2]];
    out.push_back((middle.x() > 0) + 2 * (middle.y() > 0) + 4 * (middle.z() > 0));
  }
  return out;
}

std::map<std::size_t, int> edges_by_triangles(const Triangles& triangles) {
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::size_t> edges;
  for (const auto& t : triangles)
    for (std::size_t k = 0; k < 3; ++k) ++edges[std::minmax(t[k], t[(k + 1) % 3])];
  std::map<std::size_t, int> out;
  for (const auto& [edge, count] : edges) ++out[count];
  return out;
}

NearestSurface surface_of(const std::vector<Eigen::Vector3f>& vertices, const Triangles& triangles) {
  std::vector<NearestSurface::Corners> out;
  for (const auto& [a, b, c] : triangles) out.push_back({vertices[a], vertices[b], vertices[c]});
  return NearestSurface(out);
}

/// Largest distance of the middles of triangles from another surface.
double farthest_middle(const std::vector<Eigen::Vector3f>& vertices, const Triangles& triangles,
                       const NearestSurface& from) {
  double out = 0;
  for (const auto& [a, b, c] : triangles) {
    const Eigen::Vector3f middle = (vertices[a] + vertices[b] + vertices[c]) / 3;
    out = std::max(out, static_cast<double>((*from(middle) - middle).norm()));
  }
  return out;
}

TEST(MeshLevels, EachHasAboutHalfOfTheTrianglesAndIsNearTheMesh) {
  const Mesh mesh = ball(80);
  const MeshLevels levels = make_mesh_levels(mesh, {});
  EXPECT_EQ(levels.why_not, "");
  ASSERT_GE(levels.levels.size(), 5u);
  ASSERT_EQ(levels.vertices.size(), mesh.vertices.size());
  EXPECT_EQ(levels.levels[0].error, 0);
  EXPECT_TRUE(levels.levels[0].source.empty());
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i)
    for (std::size_t k = 0; k < 3; ++k)
      ASSERT_EQ(levels.vertices[levels.levels[0].triangles[i][k]], mesh.vertices[mesh.triangles[i][k]]);
  const NearestSurface exact = surface_of(mesh.vertices, mesh.triangles);
  for (std::size_t l = 1; l < levels.levels.size(); ++l) {
    const MeshLevel &finer = levels.levels[l - 1], &level = levels.levels[l];
    EXPECT_LE(level.triangles.size(), 0.55 * static_cast<double>(finer.triangles.size())) << l;
    EXPECT_LT(level.vertex_count, finer.vertex_count);
    EXPECT_GT(level.error, finer.error);
    for (const auto& t : level.triangles)
      for (const std::uint32_t v : t) ASSERT_LT(v, level.vertex_count);
    EXPECT_EQ(edges_by_triangles(level.triangles).size(), 1u) << "level " << l << " has a hole or a fin";
    // The error is measured from some of the mesh's vertices; from the level's own triangles it may be a little more.
    EXPECT_LT(farthest_middle(levels.vertices, level.triangles, exact), 1.5 * level.error + 1e-6) << l;
  }
}

TEST(MeshLevels, AtTheEndOfItsWayALevelIsTheNextOne) {
  const MeshLevels levels = make_mesh_levels(ball(60), {});
  ASSERT_GE(levels.levels.size(), 4u);
  using Place = std::tuple<float, float, float>;
  const auto place = [](const Eigen::Vector3f& v) { return Place{v.x(), v.y(), v.z()}; };
  for (std::size_t l = 0; l + 1 < levels.levels.size(); ++l) {
    const MeshLevel &finer = levels.levels[l], &coarser = levels.levels[l + 1];
    std::multiset<std::array<Place, 3>> moved, next;
    for (const auto& t : finer.triangles) {
      std::array<Place, 3> p;
      for (std::size_t k = 0; k < 3; ++k)
        p[k] = place(t[k] < coarser.vertex_count ? levels.vertices[t[k]] : levels.coarser[t[k]]);
      if (p[0] != p[1] && p[1] != p[2] && p[2] != p[0]) moved.insert(p);
    }
    for (const auto& [a, b, c] : coarser.triangles)
      next.insert({place(levels.vertices[a]), place(levels.vertices[b]), place(levels.vertices[c])});
    EXPECT_TRUE(moved == next) << "level " << l;
  }
}

// A texture belongs to a part. Its triangles stay its own on all levels, and cover it; where parts meet nothing gapes.
TEST(MeshLevels, PartsKeepTheirPlace) {
  const Mesh mesh = ball(64);
  const std::vector<int> parts = eighths(mesh);
  const MeshLevels levels = make_mesh_levels(mesh, parts);
  ASSERT_GE(levels.levels.size(), 4u);
  const auto areas = [&](const MeshLevel& level) {
    std::map<int, double> out;
    for (std::size_t i = 0; i < level.triangles.size(); ++i) {
      const auto& [a, b, c] = level.triangles[i];
      const auto& v = levels.vertices;
      out[parts[level.source.empty() ? i : level.source[i]]] +=
          0.5 * static_cast<double>((v[b] - v[a]).cross(v[c] - v[a]).norm());
    }
    return out;
  };
  const auto exact = areas(levels.levels[0]);
  for (std::size_t l = 1; l < levels.levels.size(); ++l) {
    const MeshLevel& level = levels.levels[l];
    EXPECT_EQ(edges_by_triangles(level.triangles).size(), 1u) << "level " << l << " gapes";
    for (std::size_t i = 0; i < level.triangles.size(); ++i) {
      const auto& [a, b, c] = level.triangles[i];
      const Eigen::Vector3f middle = levels.vertices[a] + levels.vertices[b] + levels.vertices[c];
      const int part = parts[level.source[i]];
      for (int axis = 0; axis < 3; ++axis)
        EXPECT_GT((part >> axis & 1) ? middle[axis] : -middle[axis], -0.05f) << "level " << l << ", part " << part;
    }
    for (const auto& [part, area] : areas(level)) EXPECT_NEAR(area / exact.at(part), 1, 0.25) << l;
  }
}

TEST(MeshLevels, OpenSurfacesKeepTheirBorder) {
  const Mesh sheet = sim::woven({60, 60, false, false}, [](double u, double v) -> Eigen::Vector3d {
    return {u, v, 0.05 * std::sin(9 * u) * std::cos(7 * v)};
  });
  const MeshLevels levels = make_mesh_levels(sheet, {});
  ASSERT_GE(levels.levels.size(), 4u);
  for (const MeshLevel& level : levels.levels) {
    Eigen::AlignedBox3f box;
    for (const auto& t : level.triangles)
      for (const std::uint32_t v : t) box.extend(levels.vertices[v]);
    EXPECT_NEAR(box.min().x(), 0, 1e-6);
    EXPECT_NEAR(box.max().y(), 1, 1e-6);
    EXPECT_EQ(edges_by_triangles(level.triangles).count(3), 0u);
  }
  for (std::uint32_t v = 0; v < levels.vertices.size(); ++v) {  // on the border they move along it
    const Eigen::Vector3f &from = levels.vertices[v], &to = levels.coarser[v];
    for (int axis = 0; axis < 2; ++axis) {
      const bool on_border = from[axis] == 0 || from[axis] == 1;
      EXPECT_TRUE(!on_border || from[axis] == to[axis]) << from.transpose() << " to " << to.transpose();
    }
  }
}

TEST(MeshLevels, WhatCannotBeSimplifiedSaysWhy) {
  const SceneModel workshop = sim::make_workshop({.triangles = 20'000});
  const SceneLevels scene(workshop);
  const auto of = [&](const char* name) { return scene.nodes()[static_cast<std::size_t>(*workshop.find(name))]; };
  EXPECT_EQ(of("swarf").levels.size(), 1u);
  EXPECT_THAT(of("swarf").why_not, testing::HasSubstr("100 % of its triangles are joined to no other"));
  EXPECT_EQ(of("hall").levels.size(), 1u);
  EXPECT_EQ(of("hall").why_not, "") << "12 triangles are not worth a word";
  EXPECT_EQ(of("shelf_left_0").levels.size(), 1u);
  EXPECT_THAT(of("shelf_left_0").why_not, testing::HasSubstr("three or more triangles meet at 17 % of its edges"));
  EXPECT_EQ(scene.remarks().size(), 1u + 16u) << "swarf and racks";
  EXPECT_THAT(scene.remarks(),
              testing::Contains(testing::StartsWith("'swarf' is always drawn with all of its 3000 triangles: ")));

  Mesh doubled = ball(20);
  doubled.triangles.insert(doubled.triangles.end(), doubled.triangles.begin(), doubled.triangles.end());
  const MeshLevels held = make_mesh_levels(doubled, {});
  EXPECT_EQ(held.levels.size(), 1u);
  EXPECT_THAT(held.why_not, testing::HasSubstr("three or more triangles meet at 100 % of its edges"));

  Mesh wrong = ball(20);
  wrong.vertices[7].x() = std::numeric_limits<float>::quiet_NaN();
  const MeshLevels no_numbers = make_mesh_levels(wrong, {});
  EXPECT_EQ(no_numbers.levels.size(), 1u);
  EXPECT_EQ(no_numbers.levels[0].triangles, wrong.triangles);
  EXPECT_THAT(no_numbers.why_not, testing::HasSubstr("no numbers"));

  Mesh flat = ball(20);  // all in one point: nothing has an area
  for (auto& v : flat.vertices) v.setZero();
  EXPECT_GE(make_mesh_levels(flat, {}).levels.size(), 1u);
  EXPECT_THROW(make_mesh_levels(ball(20), std::vector<int>(3, 0)), std::invalid_argument);
}

TEST(NearestSurface, IsThatOfAllTriangles) {
  const Mesh mesh = ball(16);
  std::vector<NearestSurface::Corners> triangles;
  for (const auto& [a, b, c] : mesh.triangles)
    triangles.push_back({mesh.vertices[a], mesh.vertices[b], mesh.vertices[c]});
  const NearestSurface nearest(triangles);
  std::srand(1);
  for (int i = 0; i < 300; ++i) {
    const Eigen::Vector3f p = Eigen::Vector3f::Random() * 0.9f;
    float least = 1e9f;
    for (const auto& t : triangles) least = std::min(least, (nearest_on_triangle(t, p) - p).norm());
    ASSERT_NEAR((*nearest(p) - p).norm(), least, 1e-6);
  }
  EXPECT_FALSE(NearestSurface({})(Eigen::Vector3f::Zero()));
}

}  // namespace
}  // namespace foresight::mesh_levels_test

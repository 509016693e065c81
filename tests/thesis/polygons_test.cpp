// Polygons, their frames and their bounding boxes; no GPU.
#include "texture_gpu/thesis/polygons.hpp"

#include <gtest/gtest.h>

#include <bit>
#include <set>

#include "scene/primitives.hpp"
#include "tests/support/small_scene.hpp"
#include "texture_gpu/thesis/perspective_texture.hpp"
#include "texture_gpu/thesis/polygon_frame.hpp"

namespace foresight::thesis::polygons_test {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

SceneModel one_node(Mesh mesh) {
  return SceneModel({{"node", std::move(mesh), -1, Pose::Identity()}});
}

/// Squares of 0.1 m where `there` says so, as two triangles each.
template <typename There>
Mesh squares(int count, There&& there) {
  Mesh mesh;
  for (int y = 0; y <= count; ++y)
    for (int x = 0; x <= count; ++x)
      mesh.vertices.emplace_back(0.1f * static_cast<float>(x), 0.1f * static_cast<float>(y), 0.f);
  const auto at = [&](int x, int y) { return static_cast<std::uint32_t>(y * (count + 1) + x); };
  for (int y = 0; y < count; ++y)
    for (int x = 0; x < count; ++x)
      if (there(x, y)) {
        mesh.triangles.push_back({at(x, y), at(x + 1, y), at(x + 1, y + 1)});
        mesh.triangles.push_back({at(x, y), at(x + 1, y + 1), at(x, y + 1)});
      }
  return mesh;
}

bool convex(const Polygon& p) {
  for (std::size_t i = 0; i < p.corners.size(); ++i) {
    const Vector3d &a = p.corners[i], &b = p.corners[(i + 1) % p.corners.size()],
                   &c = p.corners[(i + 2) % p.corners.size()];
    if ((b - a).normalized().cross((c - b).normalized()).dot(p.normal) < -1e-5) return false;
  }
  return true;
}

double area(const Polygon& p) {
  Vector3d sum = Vector3d::Zero();
  for (std::size_t i = 0; i < p.corners.size(); ++i)
    sum += (p.corners[i] - p.corners[0]).cross(p.corners[(i + 1) % p.corners.size()] - p.corners[0]);
  return sum.dot(p.normal) / 2;
}

TEST(FindPolygons, ABoxHasSix) {
  const auto polygons = find_polygons(one_node(make_box({0.3, 0.2, 0.1})));
  ASSERT_EQ(polygons.size(), 6u);
  double total = 0;
  for (const Polygon& p : polygons) {
    EXPECT_EQ(p.corners.size(), 4u);
    EXPECT_GT(p.normal.dot(p.corners[0]), 0) << "outwards";
    total += area(p);
  }
  EXPECT_NEAR(total, 2 * (0.06 + 0.03 + 0.02), 1e-6);
}

TEST(FindPolygons, APlaneOfManyTrianglesIsOne) {
  for (int count : {1, 2, 5, 9}) {
    const auto polygons = find_polygons(one_node(squares(count, [](int, int) { return true; })));
    ASSERT_EQ(polygons.size(), 1u) << count;
    EXPECT_NEAR(area(polygons[0]), 0.01 * count * count, 1e-6);
  }
}

TEST(FindPolygons, WhatIsNotConvexStaysSplit) {
  const auto polygons = find_polygons(one_node(squares(4, [](int x, int y) { return x < 2 || y < 2; })));
  EXPECT_GE(polygons.size(), 2u);
  EXPECT_LE(polygons.size(), 4u);
  double total = 0;
  for (const Polygon& p : polygons) {
    EXPECT_TRUE(convex(p));
    total += area(p);
  }
  EXPECT_NEAR(total, 0.12, 1e-6);
}

TEST(FindPolygons, EveryTriangleIsInExactlyOne) {
  const SceneModel scene({{"sphere", make_sphere(0.2), -1, Pose::Identity()},
                          {"box", make_box({0.3, 0.2, 0.1}), -1, Pose::Identity()},
                          {"cylinder", make_cylinder(0.1, 0.3), -1, Pose::Identity()}});
  std::set<std::uint32_t> seen;
  std::size_t all = 0;
  for (const Node& node : scene.nodes()) all += node.mesh.triangles.size();
  for (const Polygon& p : find_polygons(scene)) {
    EXPECT_TRUE(convex(p));
    ASSERT_EQ(p.triangles.size(), p.scene_triangles.size());
    for (const std::uint32_t t : p.scene_triangles) EXPECT_TRUE(seen.insert(t).second);
    const Mesh& mesh = scene.nodes()[static_cast<std::size_t>(p.node)].mesh;
    for (const auto& t : p.triangles)
      for (const std::uint32_t v : t)
        EXPECT_NEAR(p.normal.dot(mesh.vertices[v].cast<double>() - p.corners[0]), 0, 1e-5);
  }
  EXPECT_EQ(seen.size(), all);
  EXPECT_EQ(*seen.rbegin(), all - 1);
}

// Equations 4.24 to 4.29.
TEST(PolygonFrameTest, HoldsThePolygonInPowersOfTwo) {
  const SceneModel scene({{"cylinder", make_cylinder(0.1, 0.3), -1, Pose::Identity()},
                          {"box", make_box({0.3, 0.2, 0.1}), -1, Pose::Identity()}});
  for (const auto& [density, most] : {std::pair(500.0, 256), {90.0, 64}, {1.0, 256}, {2000.0, 100}}) {
    for (const Polygon& p : find_polygons(scene)) {
      const PolygonFrame f = frame_of(p, density, most);
      EXPECT_LT((f.y - (p.corners[1] - p.corners[0]).normalized()).norm(), 1e-9);
      EXPECT_LT((f.x.cross(f.y) - p.normal).norm(), 1e-6) << "right-handed with the normal";
      double low_x = 1e9, low_y = 1e9, high_x = -1e9, high_y = -1e9;
      for (const Vector3d& corner : p.corners) {
        const Vector2d at = f.texel_of(corner);
        low_x = std::min(low_x, at.x()), high_x = std::max(high_x, at.x());
        low_y = std::min(low_y, at.y()), high_y = std::max(high_y, at.y());
        EXPECT_LT((f.at(at.x(), at.y()) - corner).norm(), 1e-6) << "the texture lies on the polygon";
      }
      EXPECT_NEAR(low_x, 0, 1e-6);
      EXPECT_NEAR(low_y, 0, 1e-6);
      EXPECT_NEAR(high_x, f.s, 1e-6);
      EXPECT_NEAR(high_y, f.t, 1e-6);
      const unsigned limit = std::bit_floor(static_cast<unsigned>(most));
      const auto wanted = [&](double length) {
        unsigned size = 1;
        while (size < length * density - 1e-6) size *= 2;
        return static_cast<int>(std::min(size, limit));
      };
      EXPECT_EQ(f.s, wanted(f.width));
      EXPECT_EQ(f.t, wanted(f.height));
    }
  }
}

gl::Faces plane_of(const Lens& lens) {
  return gl::faces_for(lens, 0);
}

Polygon square(double side) {
  const double a = side / 2;
  return {0, {{-a, -a, 0}, {a, -a, 0}, {a, a, 0}, {-a, a, 0}}, Vector3d::UnitZ(), {}, {}};
}

/// Checks the box against many points of a square of `side` metres at z = 0.
void expect_box(const std::optional<BoundingBox>& box, double side, const Pose& T_camera_node, const gl::Faces& plane) {
  double low_x = 1e9, low_y = 1e9, high_x = -1e9, high_y = -1e9;
  constexpr int kSteps = 2000;
  for (int j = 0; j <= kSteps; ++j)
    for (int i = 0; i <= kSteps; i += j % kSteps == 0 ? 1 : 5) {
      const Vector3d p =
          T_camera_node * Vector3d(side * (i / double{kSteps} - 0.5), side * (j / double{kSteps} - 0.5), 0);
      if (p.z() < gl::kNearPlane) continue;
      const double u = plane.fx * p.x() / p.z() + plane.cx, v = plane.fy * p.y() / p.z() + plane.cy;
      if (u < 0 || v < 0 || u > plane.width - 1 || v > plane.height - 1) continue;
      low_x = std::min(low_x, u), high_x = std::max(high_x, u);
      low_y = std::min(low_y, v), high_y = std::max(high_y, v);
    }
  ASSERT_EQ(box.has_value(), low_x < 1e9);
  if (!box) return;
  EXPECT_GE(box->x, 0);
  EXPECT_GE(box->y, 0);
  EXPECT_LE(box->x + box->width, plane.width);
  EXPECT_LE(box->y + box->height, plane.height);
  EXPECT_LE(box->x, std::max(0.0, low_x - 1)) << "with the border";
  EXPECT_LE(box->y, std::max(0.0, low_y - 1));
  EXPECT_GE(box->x + box->width - 1, std::min(plane.width - 1.0, high_x + 1));
  EXPECT_GE(box->y + box->height - 1, std::min(plane.height - 1.0, high_y + 1));
}

TEST(BoundingBoxTest, HoldsWhatTheImageShows) {
  const gl::Faces plane = plane_of(small_lens("pinhole"));
  for (const auto& [eye, target] : {std::pair(Vector3d(-1, -0.45, 0.8), Vector3d(0, 0, 0)),
                                    {{-1, 0.2, 0.8}, {0, 0.4, 0}},          // clipped by the image
                                    {{0.1, 0, 0.3}, {0.6, 0, 0.1}},         // partly behind
                                    {{0.2, 0.1, 0.02}, {1, 0.1, 0.02}}}) {  // to the horizon
    const Pose T_camera_node = look_at(eye, target).inverse();
    expect_box(bounding_box(square(1), T_camera_node, plane), 1, T_camera_node, plane);
  }
  // A small one is held tightly: its corners and two pixels around.
  const Pose T = look_at({-1, 0, 1}, {0, 0, 0}).inverse();
  const auto box = bounding_box(square(0.1), T, plane);
  ASSERT_TRUE(box);
  EXPECT_LE(box->width, 0.1 * plane.fx / 1.3 + 8);
  EXPECT_LE(box->height, 0.1 * plane.fy / 1.3 + 8);
}

TEST(BoundingBoxTest, NothingFromBehindAndOutOfView) {
  const gl::Faces plane = plane_of(small_lens("pinhole"));
  EXPECT_FALSE(bounding_box(square(1), look_at({-1, 0, -0.8}, {0, 0, 0}).inverse(), plane)) << "its back";
  EXPECT_FALSE(bounding_box(square(1), look_at({-2, 0, 1}, {-4, 0, 1}).inverse(), plane)) << "behind the camera";
  EXPECT_FALSE(bounding_box(square(0.2), look_at({-1, 0, 1}, {0, 3, 1}).inverse(), plane)) << "beside the image";
}

}  // namespace
}  // namespace foresight::thesis::polygons_test

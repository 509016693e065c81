#include "scene/solid.hpp"

#include <gtest/gtest.h>

#include <array>

#include "scene/mesh_builder.hpp"
#include "scene/primitives.hpp"

namespace foresight::solid_test {
namespace {

Mesh turned_round(Mesh mesh) {
  for (auto& t : mesh.triangles) std::swap(t[1], t[2]);
  return mesh;
}

/// Both in one mesh, the second so far along x, and scaled.
Mesh beside(const Mesh& a, const Mesh& b, double x, double scale = 1) {
  const std::array parts{a, b};
  const std::array T{Eigen::Affine3d::Identity(),
                     Eigen::Affine3d(Eigen::Translation3d(x, 0, 0) * Eigen::Scaling(scale))};
  return merged(parts, T);
}

const Mesh kBox = make_box({1, 2, 3});

TEST(Solid, BodiesAreSolid) {
  EXPECT_TRUE(is_solid(kBox));
  EXPECT_TRUE(is_solid(make_cylinder(0.1, 3)));
  EXPECT_TRUE(is_solid(make_sphere(2)));
}

TEST(Solid, OpenOnesAreNot) {
  Mesh open = kBox;
  open.triangles.pop_back();
  EXPECT_FALSE(is_solid(open));
  EXPECT_FALSE(is_solid(Mesh{}));
}

TEST(Solid, ATriangleTurnedRoundOpensIt) {
  Mesh mesh = kBox;
  std::swap(mesh.triangles[3][0], mesh.triangles[3][1]);
  EXPECT_FALSE(is_solid(mesh));
}

TEST(Solid, ATriangleThatIsThereTwiceIsNotSolid) {
  Mesh mesh = kBox;
  mesh.triangles.push_back(mesh.triangles[0]);
  EXPECT_FALSE(is_solid(mesh));
}

TEST(Solid, InsideOutIsNot) {
  EXPECT_FALSE(is_solid(turned_round(kBox)));
}

TEST(Solid, EveryPartCounts) {
  EXPECT_TRUE(is_solid(beside(kBox, kBox, 5)));
  EXPECT_TRUE(is_solid(beside(kBox, kBox, 0.5)));  // one in the other
  EXPECT_FALSE(is_solid(beside(kBox, turned_round(kBox), 5, 0.5)));
  EXPECT_FALSE(is_solid(beside(kBox, turned_round(kBox), 0, 0.5)));  // a cavity
}

// 1 mm large, 100 m away: its volume is a billionth of what lies between it and the origin.
TEST(Solid, SmallOnesFarAway) {
  const Mesh sphere = make_sphere(0.5);
  EXPECT_TRUE(is_solid(beside(kBox, sphere, 100, 0.002)));
  EXPECT_FALSE(is_solid(beside(kBox, turned_round(sphere), 100, 0.002)));
}

}  // namespace
}  // namespace foresight::solid_test

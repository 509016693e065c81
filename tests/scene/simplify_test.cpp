#include "scene/simplify.hpp"

#include <gtest/gtest.h>

#include <map>

#include "scene/primitives.hpp"

namespace foresight::simplify_test {
namespace {

/// A sphere of many triangles, and what each edge of a mesh has of them.
Mesh fine_sphere(double radius) {
  Mesh mesh = make_sphere(radius);
  for (int round = 0; round < 2; ++round) {
    std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> middles;
    Mesh finer{mesh.vertices, {}, 0};
    const auto middle = [&](std::uint32_t a, std::uint32_t b) {
      const auto [at, is_new] =
          middles.try_emplace(std::minmax(a, b), static_cast<std::uint32_t>(finer.vertices.size()));
      if (is_new)
        finer.vertices.push_back((mesh.vertices[a] + mesh.vertices[b]).normalized() * static_cast<float>(radius));
      return at->second;
    };
    for (const auto& [a, b, c] : mesh.triangles) {
      const std::uint32_t ab = middle(a, b), bc = middle(b, c), ca = middle(c, a);
      for (const std::array<std::uint32_t, 3>& t :
           {std::array{a, ab, ca}, std::array{b, bc, ab}, std::array{c, ca, bc}, std::array{ab, bc, ca}})
        finer.triangles.push_back(t);
    }
    mesh = finer;
  }
  return mesh;
}

std::map<int, int> edges_by_triangles(const Mesh& mesh) {
  std::map<std::pair<std::uint32_t, std::uint32_t>, int> edges;
  for (const auto& t : mesh.triangles)
    for (std::size_t k = 0; k < 3; ++k) ++edges[std::minmax(t[k], t[(k + 1) % 3])];
  std::map<int, int> out;
  for (const auto& [edge, count] : edges) ++out[count];
  return out;
}

double volume(const Mesh& mesh) {
  double sum = 0;
  for (const auto& t : mesh.triangles)
    sum += static_cast<double>(mesh.vertices[t[0]].dot(mesh.vertices[t[1]].cross(mesh.vertices[t[2]]))) / 6;
  return sum;
}

TEST(Simplify, ASphereStaysWithinTheToleranceAndClosed) {
  const Mesh fine = fine_sphere(0.1), coarse = simplified(fine, 0.001);
  EXPECT_LT(coarse.triangles.size(), fine.triangles.size() / 8);
  for (const auto& v : coarse.vertices) EXPECT_NEAR(v.norm(), 0.1, 0.002);
  for (const auto& t : coarse.triangles) {
    const Eigen::Vector3f middle = (coarse.vertices[t[0]] + coarse.vertices[t[1]] + coarse.vertices[t[2]]) / 3;
    EXPECT_GT(middle.norm(), 0.1 - 0.004) << "chords may cut in a little deeper than the vertices lie";
  }
  EXPECT_EQ(edges_by_triangles(coarse).size(), 1u);
  EXPECT_EQ(edges_by_triangles(coarse).count(2), 1u) << "no hole, no fin";
  EXPECT_NEAR(volume(coarse) / volume(fine), 1, 0.05);
  EXPECT_TRUE(simplified(fine, 0.001).vertices == coarse.vertices) << "the same every time";
}

TEST(Simplify, KeepsCornersAndBorders) {
  const Mesh box = make_box({0.2, 0.1, 0.05});
  const Mesh same = simplified(box, 0.001);
  EXPECT_EQ(same.triangles.size(), box.triangles.size());
  EXPECT_NEAR(volume(same), 0.2 * 0.1 * 0.05, 1e-7);

  Mesh sheet;  // 20 x 20 squares, flat, with a border
  for (std::uint32_t j = 0; j <= 20; ++j)
    for (std::uint32_t i = 0; i <= 20; ++i)
      sheet.vertices.emplace_back(0.01f * static_cast<float>(i), 0.01f * static_cast<float>(j), 0.0f);
  for (std::uint32_t j = 0; j < 20; ++j)
    for (std::uint32_t i = 0; i < 20; ++i) {
      const std::uint32_t a = i + 21 * j, b = a + 1, c = a + 21, d = c + 1;
      sheet.triangles.push_back({a, b, c});
      sheet.triangles.push_back({b, d, c});
    }
  const Mesh flat = simplified(sheet, 0.001);
  EXPECT_LT(flat.triangles.size(), 20u);
  double area = 0;
  Eigen::AlignedBox3f reach;
  for (const auto& t : flat.triangles)
    area += 0.5 * static_cast<double>(
                      (flat.vertices[t[1]] - flat.vertices[t[0]]).cross(flat.vertices[t[2]] - flat.vertices[t[0]]).z());
  for (const auto& v : flat.vertices) reach.extend(v);
  EXPECT_NEAR(area, 0.04, 0.0008) << "turned over, or lost a corner";
  EXPECT_NEAR(reach.sizes().x(), 0.2, 0.002);
}

}  // namespace
}  // namespace foresight::simplify_test

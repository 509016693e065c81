#include "sim/tracer.hpp"

#include <gtest/gtest.h>

#include <random>

namespace foresight::sim::tracer_test {
namespace {

TEST(Tracer, FindsWhatTryingEveryTriangleFinds) {
  std::mt19937 random(7);
  std::uniform_real_distribution<float> unit(-1, 1);
  const auto vector = [&] { return Eigen::Vector3f(unit(random), unit(random), unit(random)); };
  std::vector<Triangle> triangles;
  std::vector<Tracer> singles;
  for (int i = 0; i < 200; ++i) {
    const Eigen::Vector3f p = vector();
    triangles.push_back({p, p + 0.2f * vector(), p + 0.2f * vector()});
    singles.emplace_back(std::vector<Triangle>{triangles.back()});
  }
  const Tracer all(triangles);
  int hits = 0;
  for (int i = 0; i < 2000; ++i) {
    const Eigen::Vector3f origin = 1.5f * vector(), direction = vector();
    std::optional<Hit> expected;
    for (int k = 0; k < 200; ++k) {
      const auto hit = singles[k].nearest(origin, direction);
      if (hit && (!expected || hit->t < expected->t)) expected = Hit{k, hit->t, hit->b1, hit->b2};
    }
    const auto found = all.nearest(origin, direction);
    ASSERT_EQ(found.has_value(), expected.has_value());
    ASSERT_EQ(all.blocked(origin, direction, 1e9f), expected.has_value());
    if (!expected) continue;
    ++hits;
    EXPECT_EQ(found->triangle, expected->triangle);
    EXPECT_EQ(found->t, expected->t);
    EXPECT_FALSE(all.blocked(origin, direction, expected->t * 0.999f));
  }
  EXPECT_GT(hits, 100);
}

TEST(Tracer, HitsLieOnTheTriangle) {
  const Tracer one({{Eigen::Vector3f(0, 0, 2), Eigen::Vector3f(1, 0, 2), Eigen::Vector3f(0, 1, 2)}});
  const auto hit = one.nearest({0.25f, 0.5f, 0}, {0, 0, 1});
  ASSERT_TRUE(hit);
  EXPECT_FLOAT_EQ(hit->t, 2);
  EXPECT_FLOAT_EQ(hit->b1, 0.25f);
  EXPECT_FLOAT_EQ(hit->b2, 0.5f);
  EXPECT_FALSE(one.nearest({0.25f, 0.5f, 3}, {0, 0, 1})) << "behind the origin";
  EXPECT_TRUE(one.nearest({0.25f, 0.5f, 3}, {0, 0, -1})) << "from the other side";
}

}  // namespace
}  // namespace foresight::sim::tracer_test

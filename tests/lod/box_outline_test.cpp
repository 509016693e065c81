#include "scene/lod/box_outline.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <vector>

namespace foresight::box_outline_test {
namespace {

using Point = Eigen::Vector2d;

double cross(const Point& a, const Point& b, const Point& c) {
  return (b - a).x() * (c - a).y() - (b - a).y() * (c - a).x();
}

/// Of the convex hull, by going around it (gift wrapping).
double hull_area(const std::vector<Point>& points) {
  std::size_t start = 0;
  for (std::size_t i = 1; i < points.size(); ++i)
    if (points[i].x() < points[start].x()) start = i;
  double area = 0;
  std::size_t at = start;
  for (std::size_t steps = 0; steps <= points.size(); ++steps) {
    std::size_t next = at == 0 ? 1 : 0;
    for (std::size_t i = 0; i < points.size(); ++i)
      if (i != at && cross(points[at], points[next], points[i]) < 0) next = i;
    area += points[at].x() * points[next].y() - points[next].x() * points[at].y();
    at = next;
    if (at == start) break;
  }
  return std::abs(area) / 2;
}

TEST(BoxOutline, IsTheHullOfAllCornersFromEveryRegion) {
  std::mt19937 random(1);
  std::uniform_real_distribution any(-1.0, 1.0);
  int regions[7] = {};
  for (int i = 0; i < 3000; ++i) {
    const Eigen::Vector3d a(any(random), any(random), any(random)), b(any(random), any(random), any(random));
    const Eigen::AlignedBox3d box(a.cwiseMin(b), a.cwiseMax(b));
    const Eigen::Vector3d middle = box.center(), half = box.sizes() / 2;
    // Beyond, within or before the box along each axis, far enough that all of it lies ahead.
    Eigen::Vector3d eye;
    int beyond = 0;
    for (int axis = 0; axis < 3; ++axis) {
      const int where = (i / (axis == 0 ? 1 : axis == 1 ? 3 : 9)) % 3 - 1;
      beyond += where != 0;
      eye[axis] = middle[axis] + (where == 0 ? 0.9 * any(random) * half[axis] : where * (half[axis] + 12));
    }
    const auto outline = box_outline(box, eye);
    ++regions[outline.size()];
    if (beyond == 0) {
      EXPECT_TRUE(outline.empty());
      EXPECT_TRUE(std::isinf(seen_size(box, eye).area));
      continue;
    }
    EXPECT_EQ(outline.size(), beyond == 1 ? 4u : 6u);
    const Eigen::Vector3d ahead = (middle - eye).normalized(), side = ahead.unitOrthogonal(), up = ahead.cross(side);
    std::vector<Point> points;
    for (int c = 0; c < 8; ++c) {
      const Eigen::Vector3d p = box.corner(static_cast<Eigen::AlignedBox3d::CornerType>(c)) - eye;
      points.emplace_back(side.dot(p) / ahead.dot(p), up.dot(p) / ahead.dot(p));
    }
    const double area = hull_area(points);
    ASSERT_NEAR(seen_size(box, eye).area, area, 1e-9 + 1e-6 * area) << i;
  }
  EXPECT_GT(regions[4], 300);
  EXPECT_GT(regions[6], 1000);
  EXPECT_GT(regions[0], 50);
}

TEST(BoxOutline, AtADistanceAreaFallsWithItsSquare) {
  const Eigen::AlignedBox3d box(Eigen::Vector3d(-1, -1, -1), Eigen::Vector3d(1, 1, 1));
  const SeenSize near = seen_size(box, {0, 0, 21}), far = seen_size(box, {0, 0, 41});
  EXPECT_NEAR(near.area, 4 / 400.0, 1e-12) << "the near side hides all others";
  EXPECT_NEAR(far.area, 4 / 1600.0, 1e-12);
  EXPECT_NEAR(near.share, 1 / 400.0, 1e-12);
}

TEST(BoxOutline, BesideTheEyeItIsFiniteAndWithoutVolumeItIsSeen) {
  const Eigen::AlignedBox3d wall(Eigen::Vector3d(-50, 0.1, -3), Eigen::Vector3d(50, 0.3, 3));
  const double area = seen_size(wall, {0, 0, 0}).area;
  EXPECT_TRUE(std::isfinite(area));
  EXPECT_GT(area, 50);
  const Eigen::AlignedBox3d sheet(Eigen::Vector3d(0, 0, 0), Eigen::Vector3d(1, 1, 0));
  EXPECT_NEAR(seen_size(sheet, {0.5, 0.5, 10}).area, 0.01, 1e-12);
  EXPECT_EQ(seen_size(sheet, {5, 0.5, 0}).area, 0) << "from beside it is a line";
}

}  // namespace
}  // namespace foresight::box_outline_test

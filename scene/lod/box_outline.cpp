#include "scene/lod/box_outline.hpp"

#include <array>
#include <limits>
#include <vector>

namespace foresight {
namespace {

constexpr double kWidest = 5.67;  // tangent of 80 degrees

struct Outline {
  std::uint8_t count = 0;
  std::array<std::uint8_t, 6> corners{};
};

/// The corners of a side of the unit cube, counter-clockwise seen from outside. Side 2 a: the smaller of axis a.
constexpr std::array<std::uint8_t, 4> side_corners(int side) {
  const int axis = side / 2, b = (axis + 1) % 3, c = (axis + 2) % 3;
  const int at = side % 2 << axis, right = 1 << b, up = 1 << c;
  const std::array<int, 4> larger{at, at | right, at | right | up, at | up};
  std::array<std::uint8_t, 4> out{};
  for (std::size_t k = 0; k < 4; ++k) out[k] = static_cast<std::uint8_t>(side % 2 == 1 ? larger[k] : larger[3 - k]);
  return out;
}

/// Edges of seen sides whose other side is not seen, as a way around: from each corner to the next.
constexpr Outline outline_of(unsigned seen_sides) {
  std::array<std::array<bool, 8>, 8> edge{};
  for (int side = 0; side < 6; ++side) {
    if (!(seen_sides >> side & 1u)) continue;
    const auto corners = side_corners(side);
    for (std::size_t k = 0; k < 4; ++k) edge[corners[k]][corners[(k + 1) % 4]] = true;
  }
  Outline out;
  std::array<int, 8> next{};
  int start = -1;
  for (std::size_t a = 0; a < 8; ++a) {
    next[a] = -1;
    for (std::size_t b = 0; b < 8; ++b)
      if (edge[a][b] && !edge[b][a]) {
        next[a] = static_cast<int>(b);
        start = static_cast<int>(a);
      }
  }
  if (start < 0) return out;
  int at = start;
  do {
    out.corners[out.count++] = static_cast<std::uint8_t>(at);
    at = next[static_cast<std::size_t>(at)];
  } while (at != start && out.count < 6);
  return out;
}

/// By the bits of seen sides; those of two opposite sides never come together.
constexpr std::array<Outline, 64> kOutlines = [] {
  std::array<Outline, 64> out{};
  for (unsigned code = 0; code < 64; ++code) {
    const bool impossible = (code & 3u) == 3u || (code & 12u) == 12u || (code & 48u) == 48u;
    if (!impossible) out[code] = outline_of(code);
  }
  return out;
}();

unsigned region(const Eigen::AlignedBox3d& box, const Eigen::Vector3d& eye) {
  unsigned out = 0;
  for (int axis = 0; axis < 3; ++axis) {
    if (eye[axis] < box.min()[axis])
      out |= 1u << (2 * axis);
    else if (eye[axis] > box.max()[axis])
      out |= 2u << (2 * axis);
  }
  return out;
}

/// The part of a convex polygon (eye's frame) that a plane before the eye can show.
std::vector<Eigen::Vector3d> ahead(std::vector<Eigen::Vector3d> polygon) {
  for (const Eigen::Vector3d& inward : {Eigen::Vector3d(1, 0, kWidest), Eigen::Vector3d(-1, 0, kWidest),
                                        Eigen::Vector3d(0, 1, kWidest), Eigen::Vector3d(0, -1, kWidest)}) {
    std::vector<Eigen::Vector3d> out;
    for (std::size_t i = 0; i < polygon.size(); ++i) {
      const Eigen::Vector3d &a = polygon[i], &b = polygon[(i + 1) % polygon.size()];
      const double at = inward.dot(a), bt = inward.dot(b);
      if (at >= 0) out.push_back(a);
      if ((at >= 0) != (bt >= 0)) out.push_back(a + at / (at - bt) * (b - a));
    }
    polygon = std::move(out);
  }
  return polygon;
}

}  // namespace

std::span<const std::uint8_t> box_outline(const Eigen::AlignedBox3d& box, const Eigen::Vector3d& eye) {
  const Outline& outline = kOutlines[region(box, eye)];
  return {outline.corners.data(), outline.count};
}

SeenSize seen_size(const Eigen::AlignedBox3d& box, const Eigen::Vector3d& eye) {
  const auto corners = box_outline(box, eye);
  if (corners.empty()) return {std::numeric_limits<double>::infinity(), std::numeric_limits<double>::infinity()};
  const Eigen::Vector3d direction = (box.center() - eye).normalized();
  Eigen::Matrix3d axes;  // rows
  axes.row(2) = direction;
  axes.row(0) = direction.unitOrthogonal();
  axes.row(1) = direction.cross(axes.row(0).transpose());
  std::vector<Eigen::Vector3d> polygon;
  for (const std::uint8_t corner : corners)
    polygon.push_back(axes * (box.corner(static_cast<Eigen::AlignedBox3d::CornerType>(corner)) - eye));
  polygon = ahead(polygon);
  double area = 0, flat = 0;  // twice those of the picture and of the outline itself, along the direction
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Eigen::Vector3d &a = polygon[i], &b = polygon[(i + 1) % polygon.size()];
    area += (a.x() * b.y() - b.x() * a.y()) / (std::max(a.z(), 1e-9) * std::max(b.z(), 1e-9));
    flat += a.x() * b.y() - b.x() * a.y();
  }
  area = std::abs(area) / 2;
  flat = std::abs(flat) / 2;
  return {area, flat > 0 ? area / flat : 1 / (box.center() - eye).squaredNorm()};
}

}  // namespace foresight

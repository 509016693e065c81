#include "texture_gpu/thesis/polygon_frame.hpp"

#include <algorithm>
#include <bit>
#include <cmath>

namespace foresight::thesis {
namespace {

/// min{r_max, next power of two}, eqs. 4.28 and 4.29. r_max that is no power of two: the one below.
int texels(double length, double per_metre, int most) {
  const auto wanted = static_cast<unsigned>(std::clamp(std::ceil(length * per_metre), 1.0, 65536.0));
  return static_cast<int>(std::min(std::bit_ceil(wanted), std::bit_floor(static_cast<unsigned>(std::max(most, 1)))));
}

}  // namespace

PolygonFrame frame_of(const Polygon& polygon, double texels_per_metre, int max_texture) {
  PolygonFrame frame;
  frame.y = (polygon.corners[1] - polygon.corners[0]).normalized();  // eq. 4.25
  frame.x = frame.y.cross(polygon.normal);                           // eq. 4.24
  Eigen::Vector2d low(1e30, 1e30), high(-1e30, -1e30);
  for (const Eigen::Vector3d& corner : polygon.corners) {
    const Eigen::Vector3d p = corner - polygon.corners[0];
    const Eigen::Vector2d at(p.dot(frame.x), p.dot(frame.y));
    low = low.cwiseMin(at);
    high = high.cwiseMax(at);
  }
  frame.origin = polygon.corners[0] + low.x() * frame.x + low.y() * frame.y;
  frame.width = std::max(high.x() - low.x(), 1e-9);
  frame.height = std::max(high.y() - low.y(), 1e-9);
  frame.s = texels(frame.width, texels_per_metre, max_texture);
  frame.t = texels(frame.height, texels_per_metre, max_texture);
  return frame;
}

}  // namespace foresight::thesis

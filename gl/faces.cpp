#include "gl/faces.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace foresight::gl {
namespace {

constexpr double kWidestSingleFace = 60.0 * std::numbers::pi / 180;  // half of 120 degrees
constexpr int kLargestFace = 8192;                                   // px; a smaller scale is used beyond

Faces cube(const Lens& lens, int border_px) {
  const auto& p = lens.parameters();
  Faces faces;
  faces.count = 6;
  const double focal = std::min((p.fx + p.fy) / 2, kLargestFace / 2.0 - border_px);
  const int size = 2 * static_cast<int>(std::ceil(focal)) + 2 * border_px;
  faces.width = faces.height = size;
  faces.fx = faces.fy = focal;
  faces.cx = faces.cy = (size - 1) / 2.0;
  return faces;
}

}  // namespace

Eigen::Matrix3d Faces::rotation(int i) {
  // Rows are the face's x, y and z axes in camera coordinates.
  static const std::array<Eigen::Matrix3d, 6> rotations = [] {
    std::array<Eigen::Matrix3d, 6> r;
    r[0] << 1, 0, 0, 0, 1, 0, 0, 0, 1;
    r[1] << 0, 0, -1, 0, 1, 0, 1, 0, 0;
    r[2] << -1, 0, 0, 0, 1, 0, 0, 0, -1;
    r[3] << 0, 0, 1, 0, 1, 0, -1, 0, 0;
    r[4] << 1, 0, 0, 0, 0, -1, 0, 1, 0;
    r[5] << 1, 0, 0, 0, 0, 1, 0, -1, 0;
    return r;
  }();
  return rotations[static_cast<std::size_t>(i)];
}

Faces faces_for(const Lens& lens, int border_px) {
  const auto& p = lens.parameters();
  if (lens.max_angle() > kWidestSingleFace) return cube(lens, border_px);
  Faces faces{1, p.width, p.height, p.fx, p.fy, p.cx, p.cy};
  if (!lens.has_distortion()) return faces;

  double x0 = 0, x1 = 0, y0 = 0, y1 = 0;
  const auto include = [&](double u, double v) {
    const auto ray = lens.unproject({u, v});
    if (!ray || ray->z() <= 0.1) return;
    x0 = std::min(x0, ray->x() / ray->z());
    x1 = std::max(x1, ray->x() / ray->z());
    y0 = std::min(y0, ray->y() / ray->z());
    y1 = std::max(y1, ray->y() / ray->z());
  };
  // The lens maps straight borders to curves: sample every pixel of all four.
  for (int u = -1; u <= p.width; ++u) include(u, -0.5), include(u, p.height - 0.5);
  for (int v = -1; v <= p.height; ++v) include(-0.5, v), include(p.width - 0.5, v);

  const double room = kLargestFace - 2 * border_px - 3;  // 3: the centre's pixel, and both ends rounded up
  const double scale = std::min({1.0, room / ((x1 - x0) * p.fx), room / ((y1 - y0) * p.fy)});
  faces.fx = p.fx * scale;
  faces.fy = p.fy * scale;
  faces.cx = std::ceil(-x0 * faces.fx) + border_px;
  faces.cy = std::ceil(-y0 * faces.fy) + border_px;
  faces.width = static_cast<int>(faces.cx + std::ceil(x1 * faces.fx)) + border_px + 1;
  faces.height = static_cast<int>(faces.cy + std::ceil(y1 * faces.fy)) + border_px + 1;
  return faces;
}

}  // namespace foresight::gl

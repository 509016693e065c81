#include "texture_gpu/thesis/perspective_texture.hpp"

#include <algorithm>
#include <cmath>

namespace foresight::thesis {
namespace {

constexpr int kBorder = 2;  // px

/// The part of a polygon in front of the near plane, camera frame (Sutherland and Hodgman 1974).
std::vector<Eigen::Vector3d> in_front(const Polygon& polygon, const Pose& T_camera_node) {
  std::vector<Eigen::Vector3d> out;
  const auto& corners = polygon.corners;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const Eigen::Vector3d a = T_camera_node * corners[i], b = T_camera_node * corners[(i + 1) % corners.size()];
    const double from = a.z() - gl::kNearPlane, to = b.z() - gl::kNearPlane;
    if (from >= 0) out.push_back(a);
    if ((from >= 0) != (to >= 0)) out.push_back(a + (b - a) * (from / (from - to)));
  }
  return out;
}

}  // namespace

std::optional<BoundingBox> bounding_box(const Polygon& polygon, const Pose& T_camera_node, const gl::Faces& plane) {
  const Eigen::Vector3d normal = T_camera_node.linear() * polygon.normal;  // eq. 4.7, of a direction
  if (normal.dot(T_camera_node * polygon.corners[0]) >= 0) return std::nullopt;
  Eigen::Vector2d low(1e30, 1e30), high(-1e30, -1e30);
  for (const Eigen::Vector3d& p : in_front(polygon, T_camera_node)) {
    const Eigen::Vector2d pixel(plane.fx * p.x() / p.z() + plane.cx, plane.fy * p.y() / p.z() + plane.cy);  // eq. 4.8
    low = low.cwiseMin(pixel);
    high = high.cwiseMax(pixel);
  }
  if (low.x() >= plane.width - 0.5 || low.y() >= plane.height - 0.5 || high.x() <= -0.5 || high.y() <= -0.5)
    return std::nullopt;
  // Eqs. 4.9 to 4.12, with pixel centres at integers; far corners would not fit an int.
  const auto first = [](double v) { return static_cast<int>(std::max(std::floor(v) - kBorder, 0.0)); };
  const auto last = [](double v, int size) { return static_cast<int>(std::min(std::ceil(v) + kBorder, size - 1.0)); };
  BoundingBox box{first(low.x()), first(low.y()), 0, 0};
  box.width = last(high.x(), plane.width) - box.x + 1;    // eq. 4.13
  box.height = last(high.y(), plane.height) - box.y + 1;  // eq. 4.14
  return box;
}

PerspectiveTexture::PerspectiveTexture(const gl::Faces& plane)
    : texture_(smooth_texture(GL_RGBA8, plane.width, plane.height, "perspective texture")) {}

void PerspectiveTexture::copy(const CameraFrame& frame, const BoundingBox& box) const {
  glCopyImageSubData(frame.colour().name(), GL_TEXTURE_2D, 0, box.x, box.y, 0, texture_.name(), GL_TEXTURE_2D, 0, 0, 0,
                     0, box.width, box.height, 1);
}

}  // namespace foresight::thesis

#include "display/overlay_lines.hpp"

#include <algorithm>
#include <cmath>
#include <map>

namespace foresight {
namespace {

constexpr double kLongestLine = 100;  // m: what is longer is a mistake of the caller's

Eigen::Vector3d any_normal(const Eigen::Vector3d& axis) {
  const Eigen::Vector3d other = std::abs(axis.x()) < 0.7 ? Eigen::Vector3d::UnitX() : Eigen::Vector3d::UnitY();
  return axis.cross(other).normalized();
}

}  // namespace

WireMesh wire_of(const Mesh& mesh, double bend) {
  std::map<std::array<std::uint32_t, 2>, std::vector<Eigen::Vector3f>> normals;  // of the triangles at each edge
  for (const auto& triangle : mesh.triangles) {
    const Eigen::Vector3f &a = mesh.vertices[triangle[0]], &b = mesh.vertices[triangle[1]],
                          &c = mesh.vertices[triangle[2]];
    const Eigen::Vector3f normal = (b - a).cross(c - a).normalized();
    for (std::size_t i = 0; i < 3; ++i) {
      std::array edge{triangle[i], triangle[(i + 1) % 3]};
      if (edge[0] > edge[1]) std::swap(edge[0], edge[1]);
      normals[edge].push_back(normal);
    }
  }
  WireMesh out;
  const auto flat = static_cast<float>(std::cos(bend));
  for (const auto& [edge, sides] : normals)
    if (sides.size() != 2 || sides[0].dot(sides[1]) < flat)
      out.edges.push_back({mesh.vertices[edge[0]], mesh.vertices[edge[1]]});
  return out;
}

void OverlayLines::piece(const Eigen::Vector3d& a, const Eigen::Vector3d& b, double along, bool begins, bool ends,
                         const OverlayStyle& style) {
  const double length = (b - a).norm();
  if (!std::isfinite(length) || !a.allFinite() || length > kLongestLine) return;
  const auto parts = static_cast<std::size_t>(std::max(1.0, std::ceil(length / kLongestStroke)));
  for (std::size_t i = 0; i < parts && strokes_.size() < kMostStrokes; ++i) {
    const double from = static_cast<double>(i) / static_cast<double>(parts),
                 to = static_cast<double>(i + 1) / static_cast<double>(parts);
    strokes_.push_back({(a + from * (b - a)).cast<float>(), (a + to * (b - a)).cast<float>(),
                        static_cast<float>(along + from * length), begins && i == 0, ends && i + 1 == parts, style});
  }
}

void OverlayLines::line(const Eigen::Vector3d& a, const Eigen::Vector3d& b, const OverlayStyle& style) {
  piece(a, b, 0, true, true, style);
}

void OverlayLines::polyline(std::span<const Eigen::Vector3d> points, const OverlayStyle& style) {
  double along = 0;
  for (std::size_t i = 0; i + 1 < points.size(); ++i) {
    piece(points[i], points[i + 1], along, i == 0, i + 2 == points.size(), style);
    along += (points[i + 1] - points[i]).norm();
  }
}

void OverlayLines::dot(const Eigen::Vector3d& at, const OverlayStyle& style) {
  piece(at, at, 0, true, true, style);
}

void OverlayLines::cross(const Eigen::Vector3d& at, const Pose& T_world_axes, double size, const OverlayStyle& style) {
  for (int axis = 0; axis < 3; ++axis) {
    const Eigen::Vector3d half = 0.5 * size * T_world_axes.linear().col(axis);
    line(at - half, at + half, style);
  }
}

void OverlayLines::arc(const Eigen::Vector3d& center, const Eigen::Vector3d& axis, const Eigen::Vector3d& begin,
                       double angle, const OverlayStyle& style) {
  if (!std::isfinite(angle)) return;
  constexpr double kStep = 0.12;  // rad
  const auto parts = static_cast<std::size_t>(std::clamp(std::ceil(std::abs(angle) / kStep), 1.0, 200.0));
  std::vector<Eigen::Vector3d> points;
  for (std::size_t i = 0; i <= parts; ++i) {
    const double turned = angle * static_cast<double>(i) / static_cast<double>(parts);
    points.push_back(center + Eigen::AngleAxisd(turned, axis) * (begin - center));
  }
  polyline(points, style);
}

void OverlayLines::ring(const Eigen::Vector3d& center, const Eigen::Vector3d& axis, double radius,
                        const OverlayStyle& style) {
  if (axis.norm() < 0.5) return;
  arc(center, axis.normalized(), center + radius * any_normal(axis.normalized()), 2 * M_PI, style);
}

void OverlayLines::wire(const WireMesh& mesh, const Pose& T_world_mesh, const OverlayStyle& style) {
  for (const auto& [a, b] : mesh.edges) line(T_world_mesh * a.cast<double>(), T_world_mesh * b.cast<double>(), style);
}

}  // namespace foresight

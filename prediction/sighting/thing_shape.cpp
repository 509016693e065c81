#include "prediction/sighting/thing_shape.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <map>

namespace foresight {
namespace {

using Eigen::Vector3d;

constexpr double kNear = 1e-3;  // m
constexpr double kSurfacePoints = 600;
constexpr std::size_t kMostOutlinePoints = 4000;

struct Side {
  std::size_t triangle = 0;
  bool forward = false;  // the triangle runs along the edge from its lower to its higher vertex
};

}  // namespace

ThingShape::ThingShape(const Mesh& mesh, double spacing) : triangles_(mesh.triangles) {
  for (const Eigen::Vector3f& v : mesh.vertices) vertices_.push_back(v.cast<double>());
  if (vertices_.empty()) return;
  Vector3d least = vertices_[0], most = vertices_[0];
  for (const Vector3d& v : vertices_) {
    least = least.cwiseMin(v);
    most = most.cwiseMax(v);
  }
  middle_ = (least + most) / 2;
  radius_ = (most - least).norm() / 2;
  find_outline(spacing);
  find_surface();
}

Vector3d ThingShape::normal_of(std::size_t triangle) const {
  const auto& t = triangles_[triangle];
  return (vertices_[t[1]] - vertices_[t[0]]).cross(vertices_[t[2]] - vertices_[t[0]]).normalized();
}

void ThingShape::find_outline(double spacing) {
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::vector<Side>> edges;
  for (std::size_t i = 0; i < triangles_.size(); ++i)
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t a = triangles_[i][k], b = triangles_[i][(k + 1) % 3];
      edges[std::minmax(a, b)].push_back({i, a < b});
    }
  for (const auto& [ends, sides] : edges) {
    const Vector3d from = vertices_[ends.first], way = vertices_[ends.second] - from;
    const double length = way.norm();
    if (!(length > 0)) continue;
    OutlinePoint point;
    point.along = way / length;
    point.side[0] = point.side[1] = normal_of(sides[0].triangle);
    point.open = sides.size() != 2;
    if (sides.size() == 2) {
      const bool alike = sides[0].forward != sides[1].forward;
      point.side[1] = (alike ? 1 : -1) * normal_of(sides[1].triangle);
      if (point.side[0].dot(point.side[1]) > 1 - 1e-9) continue;  // a flat face's diagonal is never seen
    }
    const auto count = static_cast<std::size_t>(std::max(1.0, std::round(length / spacing)));
    for (std::size_t i = 0; i < count && outline_.size() < kMostOutlinePoints; ++i) {
      point.p = from + (static_cast<double>(i) + 0.5) / static_cast<double>(count) * way;
      outline_.push_back(point);
    }
  }
}

void ThingShape::find_surface() {
  std::vector<double> areas;
  double all = 0;
  for (const auto& t : triangles_) {
    areas.push_back((vertices_[t[1]] - vertices_[t[0]]).cross(vertices_[t[2]] - vertices_[t[0]]).norm() / 2);
    all += areas.back();
  }
  double due = 0;
  std::size_t made = 0;
  for (std::size_t i = 0; i < triangles_.size(); ++i) {
    const auto& t = triangles_[i];
    for (due += kSurfacePoints * areas[i] / all; due >= 1; due -= 1) {
      // Roberts' R2 sequence: even without a grid.
      const auto n = static_cast<double>(++made);
      double a = std::fmod(0.5 + 0.7548776662466927 * n, 1), b = std::fmod(0.5 + 0.5698402909980532 * n, 1);
      if (a + b > 1) {
        a = 1 - a;
        b = 1 - b;
      }
      surface_.push_back(
          {vertices_[t[0]] + a * (vertices_[t[1]] - vertices_[t[0]]) + b * (vertices_[t[2]] - vertices_[t[0]]),
           normal_of(i)});
    }
  }
}

bool ThingShape::hides(const Vector3d& eye, const Vector3d& p) const {
  const Vector3d way = p - eye;
  const double length = way.norm();
  const Vector3d d = way / length;
  for (const auto& t : triangles_) {  // Moeller and Trumbore 1997
    const Vector3d a = vertices_[t[1]] - vertices_[t[0]], b = vertices_[t[2]] - vertices_[t[0]];
    const Vector3d n = d.cross(b);
    const double det = a.dot(n);
    if (std::abs(det) < 1e-14) continue;
    const Vector3d from = eye - vertices_[t[0]];
    const double u = from.dot(n) / det;
    if (u < 0 || u > 1) continue;
    const Vector3d q = from.cross(a);
    const double v = d.dot(q) / det;
    if (v < 0 || u + v > 1) continue;
    const double range = b.dot(q) / det;
    if (range > 0 && range < length - kNear) return true;
  }
  return false;
}

}  // namespace foresight

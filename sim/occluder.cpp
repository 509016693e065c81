#include "sim/occluder.hpp"

#include <algorithm>

namespace foresight::sim {
using Eigen::Vector3f;

LampRays::LampRays(const Vector3f& p) : origin(p), axis(lamp::centre() - p), length(axis.norm()) {
  axis /= length;
  const auto& points = lamp::points();
  for (int k = 0; k < lamp::kPoints; ++k) {
    x[k] = points[k].x() - p.x();
    y[k] = points[k].y() - p.y();
    z[k] = points[k].z() - p.z();
  }
}

bool LampRays::near(const Vector3f& centre, float radius) const {
  const Vector3f d = centre - origin;
  const float along = axis.dot(d);
  if (along < -radius || along > length + lamp::kRadius + radius) return false;
  const float reach = lamp::kRadius * std::max(along, 0.0f) / length + 1.1f * radius;
  return d.squaredNorm() - along * along < reach * reach;
}

Occluder::Occluder(const std::vector<Triangle>& triangles) {
  for (const Triangle& t : triangles) {
    const Vector3f normal = (t[1] - t[0]).cross(t[2] - t[0]), centre = (t[0] + t[1] + t[2]) / 3;
    const float radius = std::max({(t[0] - centre).norm(), (t[1] - centre).norm(), (t[2] - centre).norm()});
    faces_.push_back({t, normal, normal.dot(t[0]), centre, radius});
    for (const Vector3f& p : t) box_.extend(p);
  }
  radius_ = 0.5f * box_.diagonal().norm();
}

std::uint64_t Occluder::hidden(const LampRays& rays, std::uint64_t of) const {
  if (!rays.near(box_.center(), radius_)) return 0;
  const Vector3f& p = rays.origin;
  std::uint64_t out = 0;
  for (const Face& face : faces_) {
    // Entering a closed solid means meeting a face from its front.
    if (face.normal.dot(p) <= face.offset || !rays.near(face.centre, face.radius)) continue;
    const Vector3f a = face.corners[0] - p, b = face.corners[1] - p, c = face.corners[2] - p;
    const Vector3f e0 = c.cross(b), e1 = a.cross(c), e2 = b.cross(a);
    const float volume = a.dot(e0);  // positive, as p is in front
    std::array<std::uint8_t, lamp::kPoints> meets;
    for (int k = 0; k < lamp::kPoints; ++k) {  // branch-free, for vector instructions
      const float w0 = e0.x() * rays.x[k] + e0.y() * rays.y[k] + e0.z() * rays.z[k];
      const float w1 = e1.x() * rays.x[k] + e1.y() * rays.y[k] + e1.z() * rays.z[k];
      const float w2 = e2.x() * rays.x[k] + e2.y() * rays.y[k] + e2.z() * rays.z[k];
      meets[k] = (w0 >= 0) & (w1 >= 0) & (w2 >= 0) & (w0 + w1 + w2 > volume);
    }
    for (int k = 0; k < lamp::kPoints; ++k) out |= std::uint64_t{meets[k]} << k;
    if ((out & of) == of) break;
  }
  return out & of;
}

}  // namespace foresight::sim

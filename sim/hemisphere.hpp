// Directions over a surface.
#pragma once

#include <Eigen/Core>
#include <cmath>
#include <numbers>

namespace foresight::sim {

/// The k-th of `count` directions about the unit vector `n`, dense as the cosine (Malley's method on a spiral).
inline Eigen::Vector3f cosine_direction(const Eigen::Vector3f& n, int k, int count) {
  const float r2 = (static_cast<float>(k) + 0.5f) / static_cast<float>(count);
  const float angle = static_cast<float>(k) * std::numbers::pi_v<float> * (3 - std::sqrt(5.0f));
  const float r = std::sqrt(r2);
  // Duff et al., "Building an Orthonormal Basis, Revisited", JCGT 2017.
  const float sign = std::copysign(1.0f, n.z()), a = -1 / (sign + n.z()), b = n.x() * n.y() * a;
  const Eigen::Vector3f t(1 + sign * n.x() * n.x() * a, sign * b, -sign * n.x()),
      s(b, sign + n.y() * n.y() * a, -n.y());
  return r * std::cos(angle) * t + r * std::sin(angle) * s + std::sqrt(1 - r2) * n;
}

}  // namespace foresight::sim

// What a moving part hides of the lamp. All rays of one place share their origin, so each triangle
// is set up once for all 64 points of the lamp; that is several times quicker than single rays.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "sim/lamp.hpp"
#include "sim/tracer.hpp"

namespace foresight::sim {

/// The rays from one place to all points of the lamp, and a cone around them.
struct LampRays {
  explicit LampRays(const Eigen::Vector3f& p);

  /// Whether a ray may come within `radius` of `centre`.
  bool near(const Eigen::Vector3f& centre, float radius) const;

  Eigen::Vector3f origin, axis;
  float length;
  std::array<float, lamp::kPoints> x, y, z;  ///< to each point, metres
};

/// A closed solid where it stands at one instant. Immutable; safe to share between threads.
class Occluder {
 public:
  /// `triangles`: world frame, counter-clockwise seen from outside.
  explicit Occluder(const std::vector<Triangle>& triangles);

  /// Which of the lamp points in `of` it hides from the rays' origin, which lies outside the solid.
  std::uint64_t hidden(const LampRays& rays, std::uint64_t of) const;

  const Eigen::AlignedBox3f& box() const { return box_; }

 private:
  struct Face {
    Triangle corners;
    Eigen::Vector3f normal;  // not of unit length
    float offset;            // normal . p of its plane
    Eigen::Vector3f centre;
    float radius;
  };
  std::vector<Face> faces_;
  Eigen::AlignedBox3f box_;
  float radius_ = 0;  // of the sphere around box_
};

}  // namespace foresight::sim

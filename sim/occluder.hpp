// What a moving part hides of the lamp. All rays of one place share their origin, so each triangle
// is set up once for all 64 points of the lamp; that is several times quicker than single rays.
#pragma once

#include <cstdint>
#include <vector>

#include "sim/tracer.hpp"

namespace foresight::sim {

/// A closed solid where it stands at one instant. Immutable; safe to share between threads.
class Occluder {
 public:
  /// `triangles`: world frame, counter-clockwise seen from outside.
  explicit Occluder(const std::vector<Triangle>& triangles);

  /// Which of the lamp points in `of` it hides from `p`, which lies outside the solid.
  std::uint64_t hidden(const Eigen::Vector3f& p, std::uint64_t of) const;

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
};

}  // namespace foresight::sim

// Rays against triangles, for the light of the lab: a bounding volume hierarchy.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <array>
#include <limits>
#include <optional>
#include <vector>

namespace foresight::sim {

using Triangle = std::array<Eigen::Vector3f, 3>;

struct Hit {
  int triangle = -1;     ///< index into the triangles given to the tracer
  float t = 0;           ///< distance in units of the ray's direction
  float b1 = 0, b2 = 0;  ///< barycentric weights of corners 1 and 2
};

/// Immutable; safe to share between threads. Both sides of a triangle stop a ray.
class Tracer {
 public:
  explicit Tracer(std::vector<Triangle> triangles);

  /// Nearest hit with 0 < t < t_max.
  std::optional<Hit> nearest(const Eigen::Vector3f& origin, const Eigen::Vector3f& direction,
                             float t_max = std::numeric_limits<float>::infinity()) const;
  bool blocked(const Eigen::Vector3f& origin, const Eigen::Vector3f& direction, float t_max) const;

  Eigen::AlignedBox3f bounds() const { return {nodes_[0].low, nodes_[0].high}; }

 private:
  struct BoxNode {  // 32 bytes: two in a cache line
    Eigen::Vector3f low;
    int first = 0;  // leaf: first of `count` entries of order_; inner: its second child (the first follows it)
    Eigen::Vector3f high;
    int count = 0;
  };
  struct Box {
    Eigen::AlignedBox3f box;
    Eigen::Vector3f centre;
  };
  struct Ray;
  void build(const std::vector<Box>& boxes, int begin, int end);
  int split(const std::vector<Box>& boxes, int begin, int end, const Eigen::AlignedBox3f& centres);
  template <bool kAny>
  std::optional<Hit> walk(const Eigen::Vector3f& origin, const Eigen::Vector3f& direction, float t_max) const;

  std::vector<Triangle> triangles_;
  std::vector<int> order_;
  std::vector<BoxNode> nodes_;
};

}  // namespace foresight::sim

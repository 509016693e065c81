// What of a thing's mesh an image can show: its edges and its surface, as points.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "scene/mesh.hpp"

namespace foresight {

/// A point of an edge of the mesh, in the thing's frame.
struct OutlinePoint {
  Eigen::Vector3d p;
  Eigen::Vector3d along;    ///< unit: the edge's direction
  Eigen::Vector3d side[2];  ///< unit normals of the triangles that meet here, wound alike
  bool open = false;        ///< the surface ends here
};

struct SurfacePoint {
  Eigen::Vector3d p, normal;  ///< of the triangle as it is wound
};

/// Immutable; any thread.
class ThingShape {
 public:
  /// Points of edges are `spacing` metres apart.
  explicit ThingShape(const Mesh& mesh, double spacing = 0.004);

  const std::vector<OutlinePoint>& outline() const { return outline_; }
  /// Evenly spread.
  const std::vector<SurfacePoint>& surface() const { return surface_; }
  const std::vector<Eigen::Vector3d>& vertices() const { return vertices_; }
  /// Middle and half of the diagonal of its box.
  const Eigen::Vector3d& middle() const { return middle_; }
  double radius() const { return radius_; }

  /// Is `p` hidden from `eye` by the mesh itself? Both in the thing's frame. What lies within 1 mm of `p` hides
  /// nothing.
  bool hides(const Eigen::Vector3d& eye, const Eigen::Vector3d& p) const;

 private:
  void find_outline(double spacing);
  void find_surface();
  Eigen::Vector3d normal_of(std::size_t triangle) const;

  std::vector<Eigen::Vector3d> vertices_;
  std::vector<std::array<std::uint32_t, 3>> triangles_;
  std::vector<OutlinePoint> outline_;
  std::vector<SurfacePoint> surface_;
  Eigen::Vector3d middle_ = Eigen::Vector3d::Zero();
  double radius_ = 0;
};

}  // namespace foresight

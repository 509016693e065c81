// Builds a Mesh from loose polygons: welds, triangulates, drops what has no area.
#pragma once

#include <cstdint>
#include <span>
#include <unordered_map>
#include <vector>

#include "scene/mesh.hpp"

namespace foresight {

class MeshBuilder {
 public:
  /// Adds a polygon given by its corners in order. Corners at the same place (to the bit, after
  /// rounding to float) become one vertex of the mesh. A polygon of n corners gives n - 2
  /// triangles, also where it is concave; those without area are dropped and counted. Corners
  /// must be finite as floats.
  void add(std::span<const Eigen::Vector3f> corners);

  Mesh take() && { return std::move(mesh_); }

 private:
  void add_triangle(const Eigen::Vector3f& a, const Eigen::Vector3f& b, const Eigen::Vector3f& c);
  std::uint32_t weld(const Eigen::Vector3f& v);

  struct Hash {
    std::size_t operator()(const Eigen::Vector3f& v) const;
  };
  Mesh mesh_;
  std::unordered_map<Eigen::Vector3f, std::uint32_t, Hash> index_;
};

/// One mesh of all `parts`, each moved by its `T` (which may scale), welded across them.
Mesh merged(std::span<const Mesh> parts, std::span<const Eigen::Affine3d> T);

}  // namespace foresight

// What of a mesh can touch: pieces that hang together, most of them convex.
#pragma once

#include <vector>

#include "scene/mesh.hpp"

namespace foresight {

struct MeshPiece {
  Mesh mesh;            ///< all triangles that share vertices, directly or through others
  bool convex = false;  ///< closed, and no vertex more than 0.5 mm outside of any triangle's plane
  /// Radius where it is a ball to 1 % around the middle of its box, with no fewer than 60 vertices; else 0.
  double ball_radius = 0;
};

/// A box is one piece, a crate of five boards five. Vertices are taken as welded (Mesh).
std::vector<MeshPiece> pieces_of(const Mesh& mesh);

struct Solid {
  double volume = 0;                                 ///< m^3; 0 where the surface is not closed or turned inside out
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();  ///< of mass, were it full; the box's middle where volume is 0
};
Solid solid_of(const Mesh& mesh);

}  // namespace foresight

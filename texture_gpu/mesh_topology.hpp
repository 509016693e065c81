// How the triangles of a mesh hang together.
#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

#include "scene/mesh.hpp"

namespace foresight {

/// A triangle among others.
struct Face {
  Eigen::Vector3d normal;                     // unit length
  double area = 0;                            // m^2
  std::array<int, 3> neighbours{-1, -1, -1};  // scene triangles over each edge, same node
};

/// Fills the neighbours of the mesh's triangles, which are numbered from `first` in `faces`.
void link_neighbours(const Mesh& mesh, int first, std::vector<Face>& faces);

}  // namespace foresight

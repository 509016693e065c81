// A triangle mesh as the rest of the program uses it.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <vector>

namespace foresight {

/// Triangles over shared vertices. Vertices at the same place are one vertex (the reader welds
/// them), so that neighbouring triangles share indices. Both sides of a triangle are surface.
struct Mesh {
  std::vector<Eigen::Vector3f> vertices;                ///< metres, in the frame of the mesh's node
  std::vector<std::array<std::uint32_t, 3>> triangles;  ///< indices into `vertices`, all in range
  std::size_t dropped_degenerate = 0;                   ///< triangles without area that the reader dropped
};

}  // namespace foresight

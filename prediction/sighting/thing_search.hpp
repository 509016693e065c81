// Where a thing may stand, near a place: all poses of a window, by the colours that it is known to have, else by how
// much of its outline has an edge of the pictures nearby.
//
// The latter after Hinterstoisser et al., "Gradient response maps for real-time detection of textureless objects", PAMI
// 2012: the picture's directions are spread out once (EdgePicture), so that each point of an edge is one look-up.
#pragma once

#include <span>
#include <vector>

#include "prediction/sighting/surface_colours.hpp"

namespace foresight {

struct SearchWindow {
  Pose T_world_middle = Pose::Identity();  ///< of the thing, in the window's middle
  double reach = 0.06, step = 0.006;       ///< m, along the world's x and y
  std::vector<double> turns = {0};         ///< rad, about the vertical
};

/// The best `most` of them, best first, none of them nearer than a step and a half to a better one. Any thread.
std::vector<Pose> likely_poses(const ThingShape& shape, std::size_t node, const SurfaceColours& colours,
                               std::span<const SeenBy> cameras, const SearchWindow& window, std::size_t most);

}  // namespace foresight

// Points of what stands still on which shadows of what moves may fall.
#pragma once

#include <vector>

#include "scene/scene_model.hpp"

namespace foresight {

struct Witness {
  int node = 0;
  Eigen::Vector3f point, normal;  ///< world; the normal of the side that is the triangle's front
};

/// At most `count` points, the same each time: spread evenly over the triangles of all nodes but the `moving` ones, and
/// sparser the further they are from these.
std::vector<Witness> choose_witnesses(const SceneModel& scene, const std::vector<Pose>& T_world_node,
                                      const std::vector<bool>& moving, std::size_t count);

}  // namespace foresight

// Two finely divided things beside each other, for what simplifies them. Needs foresight_sim.
#pragma once

#include <memory>
#include <random>

#include "scene/scene_model.hpp"
#include "sim/woven.hpp"

namespace foresight {

/// A block of 0.6 x 0.5 x 0.4 m at the origin, and a turned solid beside it, of about so many triangles each.
inline std::shared_ptr<const SceneModel> fine_scene(std::size_t triangles) {
  std::mt19937 random(1);
  std::vector<Node> nodes;
  nodes.push_back({"block", sim::cast_block(triangles, {0.6, 0.5, 0.4}, random), -1, Pose::Identity()});
  nodes.push_back({"solid", sim::turned_solid(triangles, 0.25, random), -1, Pose(Eigen::Translation3d(0.2, 0.6, 0))});
  return std::make_shared<const SceneModel>(std::move(nodes));
}

}  // namespace foresight

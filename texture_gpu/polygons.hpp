// A model's convex planar polygons: what its maker drew, before it was cut into triangles.
#pragma once

#include <vector>

#include "scene/scene_model.hpp"

namespace foresight {

struct Polygon {
  int node = 0;                                         ///< index in SceneModel::nodes()
  std::vector<Eigen::Vector3d> corners;                 ///< counter-clockwise seen from outside, node frame, metres
  Eigen::Vector3d normal = Eigen::Vector3d::UnitZ();    ///< unit length, node frame
  std::vector<std::array<std::uint32_t, 3>> triangles;  ///< vertex indices in the node's mesh
  std::vector<std::uint32_t> scene_triangles;           ///< the same, numbered through the whole scene
};

/// Joins neighbouring triangles that lie in one plane, as long as the result stays convex: what a
/// modeller drew as one polygon ("alle Polygone [müssen] konvex sein", section 4.3.2). Every triangle is in
/// exactly one polygon.
std::vector<Polygon> find_polygons(const SceneModel& scene);

}  // namespace foresight

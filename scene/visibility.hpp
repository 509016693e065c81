// Which nodes a pinhole can see at all: within what it sees, and through the portals of cells.
//
// Conservative: what is left out is at no pixel. An eye within a wall, where no portal leads, sees its own cell only.
#pragma once

#include <optional>

#include "scene/cells.hpp"
#include "scene/scene_model.hpp"

namespace foresight {

/// All that is seen from one point through a convex opening.
class ViewPyramid {
 public:
  /// From the middle of a pinhole (x to the right, y down, z ahead) between these tangents x / z and y / z.
  ViewPyramid(const Pose& T_world_pinhole, double left, double right, double top, double bottom);

  /// No point of the box, in a node's frame, is seen.
  bool misses(const Eigen::AlignedBox3d& box, const Pose& T_world_node) const;
  /// What is seen of it through a convex polygon (world, m); nothing where that is not seen. So close to the polygon
  /// that it cannot be told, all.
  std::optional<ViewPyramid> through(const std::vector<Eigen::Vector3d>& polygon) const;

  const Eigen::Vector3d& eye() const { return eye_; }

 private:
  Eigen::Vector3d eye_, ahead_;
  std::vector<Eigen::Vector3d> inward_;  // unit normals of planes through the eye; the first: ahead
};

/// Boxes of all nodes in their frames, and where they stand at rest.
struct NodeBoxes {
  explicit NodeBoxes(const SceneModel& scene);
  std::vector<Eigen::AlignedBox3d> box;  ///< empty where a node has no triangle
  std::vector<Pose> T_world_rest;
};

/// For each node, whether the pyramid may see it. `cells`: null, or those of the scene: a node of a cell that stands as
/// it does at rest is seen only from within its cell or through portals, from an eye that is in a cell.
std::vector<bool> visible_nodes(const ViewPyramid& pyramid, const NodeBoxes& nodes, const SceneState& state,
                                const CellGraph* cells);

}  // namespace foresight

#include "scene/scene_model.hpp"

#include <Eigen/Geometry>
#include <set>
#include <stdexcept>

namespace foresight {

SceneModel::SceneModel(std::vector<Node> nodes, std::optional<double> accuracy, std::optional<CellGraph> cells)
    : nodes_(std::move(nodes)), accuracy_(accuracy), cells_(std::move(cells)) {
  if (nodes_.empty()) throw std::invalid_argument("a scene needs at least one node");
  std::set<std::string_view> names;
  for (std::size_t i = 0; i < nodes_.size(); ++i) {
    const Node& node = nodes_[i];
    if (node.parent < -1 || node.parent >= static_cast<int>(i))
      throw std::invalid_argument("the parent of node '" + node.name + "' is not an earlier node");
    if (!names.insert(node.name).second) throw std::invalid_argument("two nodes are named '" + node.name + "'");
    triangle_count_ += node.mesh.triangles.size();
  }
  if (triangle_count_ == 0) throw std::invalid_argument("the scene has no triangle");

  const std::vector<Pose> poses = rest_poses();
  for (std::size_t i = 0; i < nodes_.size(); ++i)
    for (const Eigen::Vector3f& v : nodes_[i].mesh.vertices) box_.extend(poses[i] * v.cast<double>());
  if (cells_) check_cells(poses);
}

void SceneModel::check_cells(const std::vector<Pose>& poses) const {
  for (const Cell& cell : cells_->cells())
    for (const int index : cell.nodes) {
      if (index < 0 || index >= static_cast<int>(nodes_.size()))
        throw std::invalid_argument("cell '" + cell.name + "' holds a node that there is not");
      const Node& node = nodes_[static_cast<std::size_t>(index)];
      for (const Eigen::Vector3f& v : node.mesh.vertices)
        if (cell.box.exteriorDistance(poses[static_cast<std::size_t>(index)] * v.cast<double>()) >
            CellGraph::kTolerance)
          throw std::invalid_argument("node '" + node.name + "' sticks out of its cell '" + cell.name + "'");
    }
}

std::optional<int> SceneModel::find(std::string_view name) const {
  for (std::size_t i = 0; i < nodes_.size(); ++i)
    if (nodes_[i].name == name) return static_cast<int>(i);
  return std::nullopt;
}

std::vector<Pose> SceneModel::rest_poses() const {
  std::vector<Pose> T_world_node;
  T_world_node.reserve(nodes_.size());
  for (const Node& node : nodes_)
    T_world_node.push_back(node.parent < 0 ? node.T_parent_node
                                           : T_world_node[static_cast<std::size_t>(node.parent)] * node.T_parent_node);
  return T_world_node;
}

}  // namespace foresight

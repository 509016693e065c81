// What the scene is made of (SceneModel) and where it stands at one instant (SceneState).
//
// SceneModel is immutable and shared between threads. SceneState is a value: every image carries
// the state of its capture instant, the display draws the predicted one, and neither needs a lock.
#pragma once

#include <Eigen/Geometry>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "common/time.hpp"
#include "scene/cells.hpp"
#include "scene/mesh.hpp"

namespace foresight {

using Pose = Eigen::Isometry3d;

/// A rigid part of the scene. A node without triangles only carries its children.
struct Node {
  std::string name;
  Mesh mesh;                              ///< in the node's own frame
  int parent = -1;                        ///< index of an earlier node, or -1: the world
  Pose T_parent_node = Pose::Identity();  ///< rest pose
  bool may_move = false;                  ///< known before it does, such as a robot's link behind a joint
};

class SceneModel {
 public:
  SceneModel() = default;

  /// Throws std::invalid_argument: no node, a parent that is not an earlier node, two nodes with
  /// one name, no triangle at all; cells with a node that there is not, or that at rest sticks out of its cell.
  explicit SceneModel(std::vector<Node> nodes, std::optional<double> accuracy = std::nullopt,
                      std::optional<CellGraph> cells = std::nullopt);

  /// Largest usual distance between the model and the real surface, metres, where its maker states it.
  std::optional<double> accuracy() const { return accuracy_; }

  const std::vector<Node>& nodes() const { return nodes_; }
  /// Of a building; null where nothing is said of them.
  const CellGraph* cells() const { return cells_ ? &*cells_ : nullptr; }
  std::optional<int> find(std::string_view name) const;

  std::size_t triangle_count() const { return triangle_count_; }

  /// Axis-aligned, around all nodes in their rest poses, metres.
  const Eigen::AlignedBox3d& box() const { return box_; }
  /// Length of that box's diagonal, metres.
  double diagonal() const { return box_.isEmpty() ? 0 : box_.diagonal().norm(); }

  /// T_world_node of every node at rest.
  std::vector<Pose> rest_poses() const;

 private:
  void check_cells(const std::vector<Pose>& poses) const;

  std::vector<Node> nodes_;
  std::size_t triangle_count_ = 0;
  Eigen::AlignedBox3d box_;
  std::optional<double> accuracy_;
  std::optional<CellGraph> cells_;
};

/// How much a state can be trusted, from best to worst.
enum class StateStatus { exact, interpolated, predicted, invalid };

/// Where every node stands at one instant.
struct SceneState {
  RobotTime time;
  StateStatus status = StateStatus::invalid;
  std::vector<Pose> T_world_node;  ///< one per node of the model, in its order
};

}  // namespace foresight

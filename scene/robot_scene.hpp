// A scene and the robot in it: where every node stands for given joints.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string_view>
#include <vector>

#include "scene/scene_model.hpp"
#include "scene/urdf_reader.hpp"

namespace foresight {

/// Position of a joint by name, rad or m; nothing for one that is not known: it stays at 0 or its nearest limit.
using JointPositions = std::function<std::optional<double>(std::string_view joint)>;

/// Links with more triangles than this are simplified, to this many metres: what a camera at arm's length cannot see.
inline constexpr std::size_t kFineLink = 1000;
inline constexpr double kLinkTolerance = 0.001;

/// Immutable; safe to share between threads.
class RobotScene {
 public:
  /// `scene` may be null, and the robot absent. Its links are the nodes of their names, or come as further nodes behind
  /// where the scene has none of them. Throws InputError where the scene has some of the links and not all.
  RobotScene(const SceneModel* scene, const std::optional<UrdfRobot>& robot, const Pose& T_world_robot);

  const std::vector<Node>& nodes() const { return nodes_; }
  /// Does this node move with joints?
  bool moves(std::size_t node) const { return nodes_[node].may_move; }
  /// T_world_node of all nodes.
  std::vector<Pose> poses(const JointPositions& joints) const;
  /// All that has triangles; null where nothing has.
  const std::shared_ptr<const SceneModel>& model() const { return model_; }

 private:
  void add_robot();

  std::vector<Node> nodes_;
  std::shared_ptr<const SceneModel> model_;
  std::optional<UrdfRobot> robot_;
  Pose T_world_robot_;
  std::vector<std::size_t> node_of_link_;
};

}  // namespace foresight

#include "scene/robot_scene.hpp"

#include <algorithm>

#include "common/error.hpp"
#include "scene/simplify.hpp"

namespace foresight {

RobotScene::RobotScene(const SceneModel* scene, const std::optional<UrdfRobot>& robot, const Pose& T_world_robot)
    : robot_(robot), T_world_robot_(T_world_robot) {
  if (scene) nodes_ = scene->nodes();
  if (robot_) add_robot();
  for (Node& node : nodes_)
    if (node.parent >= 0 && nodes_[static_cast<std::size_t>(node.parent)].may_move) node.may_move = true;
  if (std::ranges::any_of(nodes_, [](const Node& node) { return !node.mesh.triangles.empty(); }))
    model_ = std::make_shared<const SceneModel>(nodes_, scene ? scene->accuracy() : std::nullopt);
}

/// Finds the robot's links among the nodes, by name, or adds them behind.
void RobotScene::add_robot() {
  const std::size_t before = nodes_.size();
  const auto place = [&](const std::string& name) {
    return static_cast<std::size_t>(std::ranges::find(nodes_, name, &Node::name) - nodes_.begin());
  };
  std::size_t found = 0;
  for (const Node& link : robot_->links) found += place(link.name) < before ? 1 : 0;
  if (found != 0 && found != robot_->links.size())
    throw InputError("the scene", "has some of the links of the robot '" + robot_->name + "', and not all",
                     "let it have all of them, by their names, or none");
  for (const Node& link : robot_->links) {
    node_of_link_.push_back(place(link.name));
    if (found != 0) continue;
    Node node = link;
    if (node.mesh.triangles.size() > kFineLink) node.mesh = simplified(node.mesh, kLinkTolerance);
    if (node.parent < 0)
      node.T_parent_node = T_world_robot_ * node.T_parent_node;
    else
      node.parent = static_cast<int>(node_of_link_[static_cast<std::size_t>(node.parent)]);
    nodes_.push_back(std::move(node));
  }
  const auto node_of = [&](int link) -> Node& { return nodes_[node_of_link_[static_cast<std::size_t>(link)]]; };
  for (const UrdfJoint& joint : robot_->joints)  // parents come first
    node_of(joint.child).may_move = joint.kind != UrdfJoint::Kind::fixed ||
                                    node_of(robot_->links[static_cast<std::size_t>(joint.child)].parent).may_move;
  for (Node& link : robot_->links) link.mesh = {};
  robot_->collision.clear();
}

std::vector<Pose> RobotScene::poses(const JointPositions& joints) const {
  std::vector<Pose> out(nodes_.size(), Pose::Identity());
  std::vector<bool> placed(nodes_.size(), false);
  const auto put = [&](std::size_t node, const Pose& T) {
    out[node] = T;
    placed[node] = true;
  };
  if (robot_) {
    put(node_of_link_[0], T_world_robot_ * robot_->links[0].T_parent_node);
    for (std::size_t j = 0; j < robot_->joints.size(); ++j) {  // joint j moves link j + 1: parents come first
      const UrdfJoint& joint = robot_->joints[j];
      const JointSource source = source_of(*robot_, j);
      const UrdfJoint& leads = robot_->joints[static_cast<std::size_t>(source.joint)];
      const double position = joints(leads.name).value_or(std::clamp(0.0, leads.lower, leads.upper));
      const auto child = static_cast<std::size_t>(joint.child);
      const auto parent = static_cast<std::size_t>(robot_->links[child].parent);
      put(node_of_link_[child], out[node_of_link_[parent]] * joint.T_parent_joint *
                                    joint_transform(joint, source.factor * position + source.offset));
    }
  }
  for (std::size_t i = 0; i < nodes_.size(); ++i)
    if (!placed[i])
      out[i] = nodes_[i].parent < 0 ? nodes_[i].T_parent_node
                                    : out[static_cast<std::size_t>(nodes_[i].parent)] * nodes_[i].T_parent_node;
  return out;
}

}  // namespace foresight

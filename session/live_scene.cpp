#include "session/live_scene.hpp"

#include <algorithm>

#include "common/error.hpp"
#include "scene/scene_reader.hpp"

namespace foresight {
namespace {

namespace fs = std::filesystem;

StereoLenses lenses_of(const sim::MockStereo& mock) {
  return {mock.lens(Side::left), mock.lens(Side::right), mock.T_left_right()};
}

std::optional<StereoLenses> lenses_of(const StereoConfig& config) {
  const auto& left = config.camera(Side::left).calibration;
  const auto& right = config.camera(Side::right).calibration;
  if (!left || !right) return std::nullopt;
  if (!right->T_left_right)
    throw InputError("the right camera's calibration", "has no T_left_right", "say where the right camera is");
  return StereoLenses{left->lens, right->lens, *right->T_left_right};
}

bool has_triangles(const std::vector<Node>& nodes) {
  return std::ranges::any_of(nodes, [](const Node& node) { return !node.mesh.triangles.empty(); });
}

}  // namespace

LiveScene::LiveScene(const sim::MockStereo& mock) : LiveScene(mock.world(), lenses_of(mock)) {}

LiveScene::LiveScene(std::shared_ptr<const sim::LiveLab> world, const StereoLenses& lenses)
    : lenses_(lenses), lab_(std::move(world)) {
  const sim::Lab& lab = lab_->lab();
  model_ = std::make_shared<const SceneModel>(sim::model_of(lab, lab_->modelled_rest()));
  for (const sim::Part& part : lab.parts) moves_.push_back(part.moves && part.name != sim::kBall);  // it has no encoder
}

LiveScene::LiveScene(const StereoConfig& cameras, const Rig* rig, const std::optional<fs::path>& scene_file)
    : lenses_(lenses_of(cameras)) {
  std::vector<Node> nodes;
  std::optional<double> accuracy;
  if (scene_file) {
    const fs::path file = fs::absolute(*scene_file);
    const SceneModel scene = read_scene(file, file.parent_path());
    nodes = scene.nodes();
    accuracy = scene.accuracy();
  }
  if (rig && rig->robot) {
    robot_ = rig->robot;
    T_world_robot_ = rig->T_world_robot;
    add_robot(nodes);
  }
  if (!has_triangles(nodes)) return;
  moves_.resize(nodes.size(), false);
  for (std::size_t i = 1; i < node_of_link_.size(); ++i) moves_[node_of_link_[i]] = true;  // the root stands
  for (std::size_t i = 0; i < nodes.size(); ++i)
    if (nodes[i].parent >= 0 && moves_[static_cast<std::size_t>(nodes[i].parent)]) moves_[i] = true;
  model_ = std::make_shared<const SceneModel>(std::move(nodes), accuracy);
}

/// Finds the robot's links among the nodes, by name, or adds them behind.
void LiveScene::add_robot(std::vector<Node>& nodes) {
  const std::size_t before = nodes.size();
  const auto place = [&](const std::string& name) {
    return static_cast<std::size_t>(std::ranges::find(nodes, name, &Node::name) - nodes.begin());
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
    if (node.parent < 0)
      node.T_parent_node = T_world_robot_ * node.T_parent_node;
    else
      node.parent = static_cast<int>(node_of_link_[static_cast<std::size_t>(node.parent)]);
    nodes.push_back(std::move(node));
  }
}

SceneState LiveScene::state_at(RobotTime time, const JointPositions& joints, StateStatus status) const {
  if (!model_) return {time, status, {}};
  if (lab_) return {time, status, lab_->modelled_state(joints)};
  const auto& nodes = model_->nodes();
  SceneState state{time, status, model_->rest_poses()};
  std::vector<bool> placed(nodes.size(), false);
  const auto put = [&](std::size_t node, const Pose& T) {
    state.T_world_node[node] = T;
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
      put(node_of_link_[child], state.T_world_node[node_of_link_[parent]] * joint.T_parent_joint *
                                    joint_transform(joint, source.factor * position + source.offset));
    }
  }
  for (std::size_t i = 0; i < nodes.size(); ++i)
    if (!placed[i] && nodes[i].parent >= 0)
      state.T_world_node[i] = state.T_world_node[static_cast<std::size_t>(nodes[i].parent)] * nodes[i].T_parent_node;
  return state;
}

Pose LiveScene::T_world_left(const JointPositions& joints) const {
  return sim::LiveLab::T_world_left_modelled(joints);
}

}  // namespace foresight

#include "seat/things_outlook.hpp"

#include <algorithm>

#include "rig/rig_scene.hpp"
#include "seat/predicted_place.hpp"
#include "sim/physics/lab_things.hpp"

namespace foresight {

std::vector<KnownThing> mock_things() {
  std::vector<KnownThing> out;
  for (const sim::LooseThing& thing : sim::lab_things()) out.push_back({thing.name, thing.mass, thing.surface});
  return out;
}

ThingsOutlook::ThingsOutlook(const Rig& rig, std::shared_ptr<const LiveScene> scene, std::vector<KnownThing> things)
    : rig_(rig), scene_(std::move(scene)) {
  for (const RigJoint& joint : rig.joints)
    if (joint.group == JointGroup::gripper) options_.jaws.push_back(joint.drive.name);
  const std::vector<Node>& nodes = scene_->model()->nodes();
  for (KnownThing& thing : things) {
    const auto found = std::ranges::find(nodes, thing.node, &Node::name);
    if (found == nodes.end()) continue;
    nodes_.push_back(static_cast<std::size_t>(found - nodes.begin()));
    options_.things.push_back(std::move(thing));
  }
}

void ThingsOutlook::advance(const PredictedRobot& robot) {
  if (robot.status == StateStatus::invalid || (!past_.empty() && robot.time <= past_.back().time)) return;
  const JointPositions by_name = positions_of(rig_, robot.position);
  const JointPositions joints = [&](std::string_view name) { return by_name(shaft_name(rig_, name)); };
  if (!future_) {
    std::vector<bool> driven;
    for (std::size_t i = 0; i < scene_->model()->nodes().size(); ++i)
      driven.push_back(scene_->moves(i) && std::ranges::find(nodes_, i) == nodes_.end());
    const PartPoses poses = [scene = scene_](const JointPositions& at) {
      return scene->state_at({}, at, StateStatus::predicted).T_world_node;
    };
    future_ = std::make_unique<ThingFuture>(*scene_->model(), driven, poses, options_, robot.time, joints);
  }
  future_->advance(robot.time, joints);
  Moment& now = past_.emplace_back();
  now.time = robot.time;
  for (std::size_t i = 0; i < future_->size(); ++i) now.T_world_thing.push_back(future_->thing(i).T_world_thing);
  while (robot.time - past_.front().time > seconds(kRemembered)) past_.pop_front();
}

void ThingsOutlook::place(SceneState& state) const {
  if (past_.empty()) return;
  auto after = std::ranges::lower_bound(past_, state.time, {}, &Moment::time);
  if (after == past_.end()) --after;
  for (std::size_t i = 0; i < nodes_.size(); ++i) state.T_world_node[nodes_[i]] = after->T_world_thing[i];
}

}  // namespace foresight

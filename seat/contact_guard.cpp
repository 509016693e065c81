#include "seat/contact_guard.hpp"

#include <algorithm>
#include <cmath>

#include "input/hand_of_rig.hpp"

namespace foresight {
namespace {

constexpr double kPressed = 5e-4;    // m or rad by which jaws are asked farther than they can go: they press
constexpr double kAtSkin = 1.5e-3;   // m: one jaw is at the thing,
constexpr double kOtherJaw = 0.012;  // and the other so near that pressing brings it there
constexpr double kOpposite = -0.7;   // cosine between the directions from which they press
constexpr double kLetGo = 1e-3;      // m or rad that jaws open before what they held is let go

std::unique_ptr<RobotShape> gate_of(const Rig& rig) {
  auto out = rig.shape();
  out->surround(rig.surroundings);
  return out;
}

// Links that any gripper of the rig moves, by a joint of its own or one that follows.
std::vector<std::string> jaws_of(const Rig& rig, const HandOptions& hand) {
  const UrdfRobot& robot = *rig.robot;
  std::vector<std::string> out;
  for (std::size_t i = 0; i < robot.joints.size(); ++i) {
    const JointSource source = source_of(robot, i);
    if (source.joint < 0) continue;
    const std::string& mover = robot.joints[static_cast<std::size_t>(source.joint)].name;
    for (std::size_t k = 0; k < rig.joints.size(); ++k)
      if (hand.roles[k] == JointRole::gripper && rig.joints[k].drive.name == mover)
        out.push_back(robot.links[static_cast<std::size_t>(robot.joints[i].child)].name);
  }
  return out;
}

FollowReason follow_reason(GhostReason reason) {
  switch (reason) {
    case GhostReason::none: return FollowReason::none;
    case GhostReason::contact:
    case GhostReason::gate: return FollowReason::contact;
    case GhostReason::joint_speed: return FollowReason::joint_speed;
    case GhostReason::joint_limit: return FollowReason::joint_limit;
    case GhostReason::singularity: return FollowReason::singularity;
    case GhostReason::out_of_reach: return FollowReason::out_of_reach;
    case GhostReason::few_joints: return FollowReason::few_joints;
    case GhostReason::other_branch: return FollowReason::other_branch;
    case GhostReason::bad_target: return FollowReason::bad_target;
    case GhostReason::unknown: return FollowReason::unknown;
  }
  return FollowReason::unknown;
}

}  // namespace

ContactGuard::ContactGuard(const Rig& rig, const HandOptions& hand, std::shared_ptr<const SceneModel> scene)
    : hand_(hand),
      scene_(std::move(scene)),
      kinematics_(*hand_.arm),
      model_(*rig.robot, rig.urdf_joint_names(), scene_.get(), rig.T_world_robot, rig.name),
      gate_(gate_of(rig)),
      T_world_base_(rig.T_world_robot),
      tool_(hand_.tip),
      jaw_names_(jaws_of(rig, hand_)) {
  const std::vector<double> anywhere(rig.joints.size(), 0.0);
  sliding_.emplace(model_, kinematics_, rig.urdf_joint_names(), anywhere, T_world_base_, gate_.get(), rig.name);
}

void ContactGuard::may_push(std::span<const std::string> nodes) {
  loose_.clear();
  for (std::size_t k = 0; k < model_.parts(); ++k)
    if (std::ranges::find(nodes, model_.part_name(k)) != nodes.end()) loose_.push_back(k);
  tell_loose();
}

// What is in the hand is part of it.
void ContactGuard::tell_loose() {
  std::vector<std::size_t> parts = loose_;
  if (grip_)
    std::erase_if(parts, [&](std::size_t k) { return model_.part_name(k) == scene_->nodes()[grip_->node].name; });
  sliding_->may_push(std::move(parts));
  still_.reset();
}

void ContactGuard::scene_stands(std::span<const Pose> T_world_node) {
  const bool same =
      std::ranges::equal(given_, T_world_node, [](const Pose& a, const Pose& b) { return a.matrix() == b.matrix(); });
  if (same) return;
  given_.assign(T_world_node.begin(), T_world_node.end());
  still_.reset();
}

// What was let go of stays there until the scene moves it.
std::vector<Pose> ContactGuard::nodes() const {
  std::vector<Pose> out = given_;
  if (left_.empty()) return out;
  if (out.empty()) out = scene_->rest_poses();
  for (const LeftThere& left : left_)
    if (left.node < out.size() && out[left.node].matrix() == left.T_world_given.matrix())
      out[left.node] = left.T_world_node;
  return out;
}

// Something else moved the arm (the switch was open, the robot was lost): all begins where it is.
void ContactGuard::stand_at(const JointValues& from) {
  const auto now = sliding_->positions();
  const bool there = std::ranges::all_of(hand_.arm_joints, [&](std::size_t i) { return now[i] == from[i]; });
  if (there && last_.valid) return;
  std::vector<double> all(from.begin(), from.begin() + static_cast<std::ptrdiff_t>(model_.joints()));
  if (grip_) all[grip_->joint] = grip_->at;
  sliding_->stand_at(all);
}

// Where the joints that are not the arm's are shown: jaws that hold something stand at it, however hard they press.
std::vector<double> ContactGuard::heed_grip(const JointValues& positions) {
  std::vector<double> out(positions.begin(), positions.begin() + static_cast<std::ptrdiff_t>(model_.joints()));
  if (!grip_) return out;
  if (grip_->closes * (out[grip_->joint] - grip_->at) > -kLetGo) {
    out[grip_->joint] = grip_->at;
    return out;
  }
  std::erase_if(left_, [&](const LeftThere& left) { return left.node == grip_->node; });
  const Pose given = given_.empty() ? scene_->rest_poses()[grip_->node] : given_[grip_->node];
  left_.push_back({grip_->node, given, T_world_of(grip_->node)});
  model_.detach(grip_->node);
  grip_.reset();
  tell_loose();
  return out;
}

Pose ContactGuard::T_world_of(std::size_t node) const {
  for (std::size_t k = 0; k < model_.parts(); ++k)
    if (model_.part_name(k) == scene_->nodes()[node].name) return model_.T_world_part(k);
  return Pose::Identity();
}

// A node of the scene that two jaws have between them.
std::optional<std::size_t> ContactGuard::between_jaws() const {
  const auto of_jaw = [&](const Nearness& n) { return std::ranges::count(jaw_names_, model_.name(n.couple)) > 0; };
  for (const Nearness& a : last_.near) {
    if (a.distance > kAtSkin || !of_jaw(a)) continue;
    for (const Nearness& b : last_.near) {
      const bool both = of_jaw(b) && b.distance <= kOtherJaw && model_.name(a.couple) != model_.name(b.couple) &&
                        model_.other_name(a.couple) == model_.other_name(b.couple);
      if (!both || !(a.direction.dot(b.direction) < kOpposite)) continue;
      const auto node = scene_ ? scene_->find(model_.other_name(a.couple)) : std::nullopt;
      if (node) return static_cast<std::size_t>(*node);
    }
  }
  return std::nullopt;
}

void ContactGuard::look_for_grip(const JointValues& asked) {
  if (grip_ || !last_.valid) return;
  for (std::size_t i = 0; i < hand_.roles.size(); ++i) {
    const double left = asked[i] - last_.positions[i];
    const double closes = hand_.gripper_opens_up ? -1 : 1;
    if (hand_.roles[i] != JointRole::gripper || closes * left < kPressed) continue;
    const auto node = between_jaws();
    if (!node) return;
    model_.attach(*node, tool_, model_.links().T_world_link(tool_).inverse() * T_world_of(*node));
    grip_ = Grip{*node, i, last_.positions[i], closes};
    tell_loose();
    return;
  }
}

FollowStep ContactGuard::told(const JointValues& from, const JointValues& asked, HandStep step) {
  still_.reset();
  FollowStep out;
  out.q.resize(static_cast<Eigen::Index>(hand_.arm_joints.size()));
  for (std::size_t i = 0; i < hand_.arm_joints.size(); ++i) {
    const std::size_t joint = hand_.arm_joints[i];
    out.q[static_cast<Eigen::Index>(i)] = step.valid ? step.positions[joint] : from[joint];
  }
  out.T_base_tip = step.T_base_tip;
  out.reason = follow_reason(step.ghost.reason);
  out.joint = step.joint;
  out.position_error = step.ghost.ahead;
  out.rotation_error = step.ghost.turned;
  last_ = std::move(step);
  near_.clear();
  for (const Nearness& n : last_.near) {  // before a grip gives couples other numbers
    if (near_.size() == kMostNear) break;
    near_.push_back({model_.name(n.couple), model_.other_name(n.couple), n.distance, n.point, n.other_point});
  }
  look_for_grip(asked);
  return out;
}

FollowStep ContactGuard::step(const JointValues& from, const Pose& T_base_target, double dt) noexcept {
  // A hand that is still: what was told the last time, and moved nothing, holds.
  const bool same = still_ && still_->from == from && still_->T_base_target.matrix() == T_base_target.matrix();
  if (same) return still_->step;
  stand_at(from);
  const std::vector<double> others = heed_grip(from);
  FollowStep out = told(from, from, sliding_->step(T_base_target, others, nodes(), dt));
  const bool settled =
      out.reason == FollowReason::none || out.reason == FollowReason::contact || out.reason == FollowReason::few_joints;
  if (settled && std::ranges::all_of(hand_.arm_joints, [&, i = Eigen::Index{0}](std::size_t joint) mutable {
        return out.q[i++] == from[joint];
      }))
    still_ = Still{from, T_base_target, out};
  return out;
}

FollowStep ContactGuard::go(const JointValues& from, const JointValues& to) noexcept {
  still_.reset();
  stand_at(from);
  return told(from, to, sliding_->go_to(heed_grip(to), nodes()));
}

TouchSight ContactGuard::sight() const {
  TouchSight out;
  out.known = last_.valid;
  out.ghost = last_.ghost;
  out.near = near_;
  if (grip_) out.carried = scene_->nodes()[grip_->node].name;
  return out;
}

}  // namespace foresight

#include "input/hand_of_rig.hpp"

#include <algorithm>

#include "common/error.hpp"

namespace foresight {
namespace {

bool is_of(const Rig& rig, JointGroup group, const std::string& joint) {
  return std::ranges::any_of(rig.joints, [&](const RigJoint& j) { return j.drive.name == joint && j.group == group; });
}

// The joint whose drive moves it: itself, or the one that it follows.
const std::string& mover_of(const UrdfRobot& robot, std::size_t joint) {
  const int source = source_of(robot, joint).joint;
  return robot.joints[source < 0 ? joint : static_cast<std::size_t>(source)].name;
}

JointRole role_of(JointGroup group) {
  switch (group) {
    case JointGroup::arm: return JointRole::arm;
    case JointGroup::gripper: return JointRole::gripper;
    case JointGroup::pan_tilt: return JointRole::other;
  }
  return JointRole::other;
}

ArmChain within(const ArmChain& chain, const HandOptions& options, const Pose& T_tip_tool, const std::string& where) {
  std::vector<ArmJoint> joints(chain.joints().begin(), chain.joints().end());
  for (std::size_t i = 0; i < joints.size(); ++i) {
    const JointLimits& limits = options.gate.joints[options.arm_joints[i]].limits;
    joints[i].lower = std::max(joints[i].lower, limits.min_position);
    joints[i].upper = std::min(joints[i].upper, limits.max_position);
    joints[i].velocity = joints[i].velocity_known ? std::min(joints[i].velocity, limits.velocity) : limits.velocity;
    joints[i].velocity_known = true;
  }
  return {std::move(joints), chain.tip_at_zero() * T_tip_tool, where, chain.followers()};
}

}  // namespace

std::string tool_link(const Rig& rig) {
  const UrdfRobot& robot = *rig.robot;
  using Count = std::pair<int, int>;                  // of drives, then of what follows them
  std::vector<Count> arm_joints(robot.links.size());  // on the way from the root; parents come first
  std::string found;
  Count most;
  bool two = false;
  for (std::size_t i = 0; i < robot.joints.size(); ++i) {
    const UrdfJoint& joint = robot.joints[i];
    const auto child = static_cast<std::size_t>(joint.child);
    const bool arm = joint.kind != UrdfJoint::Kind::fixed && is_of(rig, JointGroup::arm, mover_of(robot, i));
    Count& here = arm_joints[child] = arm_joints[static_cast<std::size_t>(robot.links[child].parent)];
    if (!arm) continue;
    ++(joint.mimic ? here.second : here.first);
    if (here < most) continue;
    two = here == most;
    most = here;
    found = robot.links[child].name;
  }
  if (found.empty()) throw InputError(rig.name, "has no arm joint that its URDF knows", "give joints the group `arm`");
  if (two)
    throw InputError(rig.name, "has more than one arm",
                     "make a rig of each, in whose URDF the other one's joints are fixed");
  return found;
}

Pose grip_point(const Rig& rig, const std::string& tip) {
  const UrdfRobot& robot = *rig.robot;
  const auto found = std::ranges::find(robot.links, tip, &Node::name);
  if (found == robot.links.end()) throw InputError(rig.name, "has no link '" + tip + "'", "name one that it has");
  const auto at = static_cast<std::size_t>(found - robot.links.begin());
  std::vector<Pose> T_tip_link(robot.links.size(), Pose::Identity());
  std::vector<bool> beyond(robot.links.size(), false), grips(robot.links.size(), false);
  Eigen::AlignedBox3d box;
  for (std::size_t i = 0; i < robot.joints.size(); ++i) {
    const auto child = static_cast<std::size_t>(robot.joints[i].child);
    const auto parent = static_cast<std::size_t>(robot.links[child].parent);
    if (parent != at && !beyond[parent]) continue;
    beyond[child] = true;
    T_tip_link[child] = T_tip_link[parent] * robot.links[child].T_parent_node;
    grips[child] = grips[parent] || is_of(rig, JointGroup::gripper, mover_of(robot, i));
    if (!grips[child]) continue;
    for (const Eigen::Vector3f& vertex : robot.body(child).vertices)
      box.extend(T_tip_link[child] * vertex.cast<double>());
  }
  Pose out = Pose::Identity();
  if (!box.isEmpty()) out.translation() = box.center();
  return out;
}

HandOptions hand_options(const Rig& rig, const std::string& tip, const Pose& T_tip_tool) {
  HandOptions out;
  out.gate = rig.gate_options();
  for (std::size_t i = 0; i < rig.joints.size(); ++i) {
    out.roles.push_back(role_of(rig.joints[i].group));
    out.start.push_back(rig.joints[i].start);
    if (rig.joints[i].group == JointGroup::pan_tilt) (out.pan ? out.tilt : out.pan) = i;  // in this order, as rigs say
  }
  const bool any_arm = std::ranges::find(out.roles, JointRole::arm) != out.roles.end();
  if (!rig.robot || (!any_arm && tip.empty())) return out;
  const std::string on = tip.empty() ? tool_link(rig) : tip;
  const ArmChain chain = arm_chain(*rig.robot, on, "", rig.name);
  out.tip = static_cast<std::size_t>(std::ranges::find(rig.robot->links, on, &Node::name) - rig.robot->links.begin());
  const std::vector<std::string> names = rig.joint_names();
  for (const ArmJoint& joint : chain.joints()) {
    const auto found = std::ranges::find(names, joint.name);
    if (found == names.end())
      throw InputError(rig.name, "has no joint '" + joint.name + "', which is on the way to the tool",
                       "add it to the rig's joints, or make it fixed in the URDF");
    out.arm_joints.push_back(static_cast<std::size_t>(found - names.begin()));
  }
  out.arm = within(chain, out, T_tip_tool, rig.name);
  return out;
}

HandOptions arm_options(const Rig& rig) {
  HandOptions out = hand_options(rig);
  if (!out.arm)
    throw InputError(rig.name,
                     rig.robot ? "no joint has `group: arm`, so that there is no tool to be moved"
                               : "the rig has no robot, whose tool could be moved",
                     rig.robot ? "give the arm's joints `group: arm` (docs/rig-files.md)"
                               : "give it a `robot:` section with a URDF (docs/rig-files.md)");
  return out;
}

}  // namespace foresight

#include "input/hand_of_rig.hpp"

#include <algorithm>

#include "common/error.hpp"

namespace foresight {
namespace {

bool is_arm(const Rig& rig, const std::string& joint) {
  return std::ranges::any_of(rig.joints,
                             [&](const RigJoint& j) { return j.drive.name == joint && j.group == JointGroup::arm; });
}

JointRole role_of(JointGroup group) {
  switch (group) {
    case JointGroup::arm: return JointRole::arm;
    case JointGroup::gripper: return JointRole::gripper;
    case JointGroup::pan_tilt: return JointRole::other;
  }
  return JointRole::other;
}

ArmChain within(const ArmChain& chain, const HandOptions& options, const std::string& where) {
  std::vector<ArmJoint> joints(chain.joints().begin(), chain.joints().end());
  for (std::size_t i = 0; i < joints.size(); ++i) {
    const JointLimits& limits = options.gate.joints[options.arm_joints[i]].limits;
    joints[i].lower = std::max(joints[i].lower, limits.min_position);
    joints[i].upper = std::min(joints[i].upper, limits.max_position);
    joints[i].velocity = joints[i].velocity_known ? std::min(joints[i].velocity, limits.velocity) : limits.velocity;
    joints[i].velocity_known = true;
  }
  return {std::move(joints), chain.tip_at_zero(), where};
}

}  // namespace

std::string tool_link(const Rig& rig) {
  const UrdfRobot& robot = *rig.robot;
  std::vector<int> arm_joints(robot.links.size(), 0);  // on the way from the root; parents come first
  std::string found;
  int most = 0;
  bool two = false;
  for (std::size_t i = 0; i < robot.joints.size(); ++i) {
    const auto child = static_cast<std::size_t>(robot.joints[i].child);
    const bool arm = is_arm(rig, robot.joints[i].name);
    arm_joints[child] = arm_joints[static_cast<std::size_t>(robot.links[child].parent)] + (arm ? 1 : 0);
    if (!arm || arm_joints[child] < most) continue;
    two = arm_joints[child] == most;
    most = arm_joints[child];
    found = robot.links[child].name;
  }
  if (found.empty()) throw InputError(rig.name, "has no arm joint that its URDF knows", "give joints the group `arm`");
  if (two) throw InputError(rig.name, "has more than one arm", "name the tool's link: --tip LINK");
  return found;
}

HandOptions hand_options(const Rig& rig, const std::string& tip) {
  HandOptions out;
  out.gate = rig.gate_options();
  for (const RigJoint& joint : rig.joints) out.roles.push_back(role_of(joint.group));
  const bool any_arm = std::ranges::find(out.roles, JointRole::arm) != out.roles.end();
  if (!rig.robot || (!any_arm && tip.empty())) return out;
  const ArmChain chain = arm_chain(*rig.robot, tip.empty() ? tool_link(rig) : tip, "", rig.name);
  const std::vector<std::string> names = rig.joint_names();
  for (const ArmJoint& joint : chain.joints()) {
    const auto found = std::ranges::find(names, joint.name);
    if (found == names.end())
      throw InputError(rig.name, "has no joint '" + joint.name + "', which is on the way to the tool",
                       "name another link: --tip LINK");
    out.arm_joints.push_back(static_cast<std::size_t>(found - names.begin()));
  }
  out.arm = within(chain, out, rig.name);
  return out;
}

}  // namespace foresight

#include "apps/rig_feed.hpp"

#include <limits>
#include <memory>

#include "drivers/robot/robot_words.hpp"

namespace foresight {

std::function<std::optional<LiveRig>()> rig_feed(const Rig& rig, const Robot& robot) {
  const auto cycles = std::make_shared<BroadcastRing<RobotCycle>::Reader>(robot.cycles());
  return [&robot, cycles, joints = rig.joint_words()]() -> std::optional<LiveRig> {
    std::optional<RobotCycle> newest;
    while (const auto cycle = cycles->take()) newest = *cycle;
    if (!newest) return std::nullopt;
    LiveRig out;
    for (std::size_t i = 0; i < newest->joints; ++i) {
      const JointCycle& joint = newest->joint[i];
      out.positions.push_back(joint.homed ? joint.position : std::numeric_limits<double>::quiet_NaN());
    }
    const RobotStatus status = robot.status();
    const std::string held = hold_text(status.gate.hold, joints, status.time);
    out.state = held.empty() ? describe(status, joints).name : held;
    out.is_bad = newest->phase == RobotPhase::stopped || !held.empty();
    return out;
  };
}

}  // namespace foresight

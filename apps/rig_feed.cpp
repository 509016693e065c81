#include "apps/rig_feed.hpp"

#include <limits>
#include <memory>

namespace foresight {
namespace {

std::string state_text(const RobotCycle& cycle) {
  std::string out = to_string(cycle.phase);
  if (cycle.phase == RobotPhase::ready) out += std::string(", ") + to_string(cycle.gate);
  if (cycle.reason != GateReason::none) out += std::string(": ") + to_string(cycle.reason);
  return out;
}

}  // namespace

std::function<std::optional<LiveRig>()> rig_feed(const Robot& robot) {
  const auto cycles = std::make_shared<BroadcastRing<RobotCycle>::Reader>(robot.cycles());
  return [cycles]() -> std::optional<LiveRig> {
    std::optional<RobotCycle> newest;
    while (const auto cycle = cycles->take()) newest = *cycle;
    if (!newest) return std::nullopt;
    LiveRig out;
    for (std::size_t i = 0; i < newest->joints; ++i) {
      const JointCycle& joint = newest->joint[i];
      out.positions.push_back(joint.homed ? joint.position : std::numeric_limits<double>::quiet_NaN());
    }
    out.state = state_text(*newest);
    out.is_bad = newest->phase == RobotPhase::stopped;
    return out;
  };
}

}  // namespace foresight

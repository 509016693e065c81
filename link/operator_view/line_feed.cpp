#include "link/operator_view/line_feed.hpp"

#include <fmt/core.h>

namespace foresight::link {
namespace {

std::string trouble_of(OperatorEnd& end) {
  const LineFigures figures = end.figures();
  const IntakeCounts& pairs = figures.pairs;
  if (const auto heard = end.robot_state(); heard && !heard->state.cameras.fault.empty())
    return heard->state.cameras.fault;
  if (!pairs.refusal.empty()) return "a pair was refused: " + pairs.refusal;
  if (pairs.others > 0 && pairs.packets == 0) return "the robot's pictures go to another program";
  return figures.clock ? "no pairs come" : "nothing is heard of the robot";
}

}  // namespace

SceneState scene_at(const Rig& rig, const LiveScene& scene, RobotTime time, const LineJoints& joints) {
  const StateStatus status = joints.status == StateStatus::invalid ? StateStatus::predicted : joints.status;
  return scene.state_at(
      time, [&](std::string_view name) { return joints.position(shaft_name(rig, name)); }, status);
}

LiveFeed line_feed(OperatorEnd& end, const Rig& rig, std::shared_ptr<const LiveScene> scene,
                   const LineFeedOptions& options) {
  const auto at = [scene, &rig](RobotTime time, const LineJoints& joints) {
    return scene_at(rig, *scene, time, joints);
  };
  return {[&end, at, margin = options.margin_px](Duration timeout) -> std::optional<LiveImage> {
            const auto frame = end.frames().take_newest(timeout);
            if (!frame) return std::nullopt;
            return LiveImage{(*frame)->number, posed_frame(**frame, at, margin)};
          },
          [&end] { return end.frames().closed(); }, [&end] { return trouble_of(end); }};
}

}  // namespace foresight::link

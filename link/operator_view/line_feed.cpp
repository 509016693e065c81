#include "link/operator_view/line_feed.hpp"

#include <fmt/core.h>

namespace foresight::link {

std::string why_no_images(const LineFigures& figures, const std::optional<OperatorEnd::HeardState>& heard,
                          std::optional<Duration> control_age) {
  if (!heard || !control_age || *control_age > ControlSeatStatus::kSilentAfter) return "nothing is heard of the robot";
  const CameraLines& cameras = heard->state.cameras;
  if (!cameras.fault.empty()) return cameras.fault;
  if (!cameras.present) return "its program runs without cameras";
  const IntakeCounts& pairs = figures.pairs;
  if (pairs.refuses) return "the last that came were refused: " + pairs.refusal;
  if (pairs.others > 0 && pairs.packets == 0) return "the robot's pictures go to another program";
  return "the robot is heard, and none come";
}

std::string why_no_images(OperatorEnd& end) {
  const auto control_age = end.seat([](ControlSeat& seat, OperatorTime now) { return seat.status(now).state_age; });
  return why_no_images(end.figures(), end.robot_state(), control_age);
}

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
          [&end] { return end.frames().closed(); }, [&end] { return why_no_images(end); }};
}

}  // namespace foresight::link

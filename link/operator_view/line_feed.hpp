// What comes over the line, as LiveSource takes it: the view of an operator's program is that of a robot's own.
#pragma once

#include "display/live_source.hpp"
#include "link/operator_side/operator_end.hpp"
#include "session/live_scene.hpp"

namespace foresight::link {

struct LineFeedOptions {
  double margin_px = 1.5;  ///< LiveFrameOptions::margin_px
};

/// Where all nodes of `rig`'s `scene` stood, by the joints that came with a pair; those that nobody knows stand at
/// rest.
SceneState scene_at(const Rig& rig, const LiveScene& scene, RobotTime time, const LineJoints& joints);

/// Why no pair comes, in words, as far as the robot told it or what came shows it. `heard`: OperatorEnd::robot_state();
/// `control_age`: ControlSeatStatus::state_age.
std::string why_no_images(const LineFigures& figures, const std::optional<OperatorEnd::HeardState>& heard,
                          std::optional<Duration> control_age);
std::string why_no_images(OperatorEnd& end);

/// Takes from `end` the newest pair that is there, as the line brought it: with its delay, so that LiveSource needs
/// none. Times are the robot's. `trouble` tells what keeps pictures away, in words. `end` and `rig` must outlive the
/// feed; one thread.
LiveFeed line_feed(OperatorEnd& end, const Rig& rig, std::shared_ptr<const LiveScene> scene,
                   const LineFeedOptions& options = {});

}  // namespace foresight::link

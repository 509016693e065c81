// What every seat begins with, whoever sits at it.
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>

#include "apps/replay_report/replay_report.hpp"
#include "display/view_session.hpp"
#include "link/dds/pretended_line.hpp"
#include "link/operator_side/operator_end.hpp"
#include "rig/rig.hpp"
#include "seat/scripted_driver.hpp"
#include "session/live_scene.hpp"

namespace foresight {

/// The operator's end of a line that is made up, running; null without one. `clock` must outlive it.
std::shared_ptr<link::PretendedLine> begin_line(const std::optional<LineSpec>& spec, const Clock& clock);

/// Of rig and scene as this side has them, with the operator's name.
Identity seat_identity(const Rig& rig, const std::filesystem::path& rig_file, const LiveScene& scene,
                       const std::string& name);

/// What comes over the line of the robot; `end` must outlive it.
ScriptedDriver::RobotSays robot_says(const link::OperatorEnd& end);

/// A seat's session before its first image, as a report begins.
RunRecord describe_seat(const Rig& rig, const ViewSession& session, const ViewSetup& setup);

}  // namespace foresight

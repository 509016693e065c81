// The robot's state as text for a terminal.
#pragma once

#include <string>
#include <vector>

#include "drivers/robot/robot.hpp"
#include "rig/robot_devices.hpp"

namespace foresight {

/// Several lines: what the robot does and why, what holds it back, what to do next, a line per joint, a line per bus,
/// punctuality of the loop. `selected`: the joint that the keys move, or -1. `line_stopper`: of who_stopped().
std::string status_text(const Rig& rig, const RobotStatus& status, const std::vector<BusLine>& buses, int selected,
                        const std::string& line_stopper = "");

}  // namespace foresight

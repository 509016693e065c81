// Which of several commanders stopped the robot, in words.
#pragma once

#include <string>

#include "drivers/robot/robot.hpp"

namespace foresight {

/// "asked for over the line by 'anna'": of a robot that is stopped by an operator. "" where it is not, or where
/// something else was asked for since. `line_stopper`: who asked for the newest stop over the line; "" where that is
/// not known.
std::string who_stopped(const RobotStatus& status, const std::string& line_stopper = "");

/// What describe() says of the robot, and who_stopped() behind it.
std::string name_and_who(const std::string& name, const RobotStatus& status, const std::string& line_stopper = "");

}  // namespace foresight

// Which of several commanders stopped the robot, in words.
#pragma once

#include <string>

#include "drivers/robot/robot.hpp"

namespace foresight {

/// "asked for over the line": of a robot that is stopped by an operator. "" where it is not, or where something else
/// was asked for since.
std::string who_stopped(const RobotStatus& status);

/// What describe() says of the robot, and who_stopped() behind it.
std::string name_and_who(const std::string& name, const RobotStatus& status);

}  // namespace foresight

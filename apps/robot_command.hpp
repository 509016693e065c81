// `foresight robot`: runs the robot side of a rig.
#pragma once

#include <functional>

#include "apps/command_line/command_line.hpp"

namespace foresight {

void add_robot_command(Command& app, std::function<int()>& action);

}  // namespace foresight

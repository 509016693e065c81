// `foresight robot`: runs the robot side of a rig.
#pragma once

#include <CLI/CLI.hpp>
#include <functional>

namespace foresight {

void add_robot_command(CLI::App& app, std::function<int()>& action);

}  // namespace foresight

// foresight operator: an operator's seat at a robot's line.
#pragma once

#include <functional>

#include "apps/command_line/command_line.hpp"

namespace foresight {

void add_operator_command(Command& app, std::function<int()>& action);

}  // namespace foresight

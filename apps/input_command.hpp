// `foresight input`: looks at the devices of the operator's hand.
#pragma once

#include <functional>

#include "apps/command_line/command_line.hpp"

namespace foresight {

void add_input_command(Command& app, std::function<int()>& action);

}  // namespace foresight

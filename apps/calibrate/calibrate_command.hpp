// `foresight calibrate COMMAND`: one file per command beside this one.
#pragma once

#include <functional>

#include "apps/command_line/command_line.hpp"

namespace foresight {

void add_calibrate_command(Command& app, std::function<int()>& action);

}  // namespace foresight

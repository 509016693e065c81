// `foresight rig`: what there is to do with rig files, but for running them.
#pragma once

#include "apps/command_line/command_line.hpp"

namespace foresight {

void add_rig_command(Command& app, std::function<int()>& action);

}  // namespace foresight

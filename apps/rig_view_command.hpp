// `foresight rig view`: a rig in three dimensions.
#pragma once

#include "apps/command_line/command_line.hpp"

namespace foresight {

void add_rig_view_command(Command& rig, std::function<int()>& action);

}  // namespace foresight

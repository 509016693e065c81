// `foresight rig new`: the first rig of one's own robot, of its URDF.
#pragma once

#include <functional>

#include "apps/command_line/command_line.hpp"

namespace foresight {

/// Adds the subcommand to `rig`; `action` is set to its work where it is chosen.
void add_rig_new_command(Command& rig, std::function<int()>& action);

}  // namespace foresight

// `foresight rig`: what there is to do with rig files, but for running them.
#pragma once

#include <functional>

#include "apps/command_line/command_line.hpp"

namespace foresight {

/// Adds the subcommand; `action` is set to its work where it is chosen.
void add_rig_command(Command& app, std::function<int()>& action);

}  // namespace foresight

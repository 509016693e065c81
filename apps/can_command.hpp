// Command line of `foresight can`: looking at CAN buses and talking to them by hand.
#pragma once

#include <functional>

#include "apps/command_line/command_line.hpp"

namespace foresight {

/// Adds the subcommand; when it is chosen, `action` becomes what main() is to run.
void add_can_command(Command& app, std::function<int()>& action);

}  // namespace foresight

// Command line of `foresight replay`.
#pragma once

#include <functional>

#include "apps/command_line/command_line.hpp"

namespace foresight {

/// Adds the subcommand; when it is chosen, `action` becomes what main() is to run.
void add_replay_command(Command& app, std::function<int()>& action);

}  // namespace foresight

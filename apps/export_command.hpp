// The options of `foresight export`.
#pragma once

#include <functional>

#include "apps/command_line/command_line.hpp"

namespace foresight {

/// Adds the subcommand; when it is given, `action` becomes what to do, returning the exit code.
void add_export_command(Command& app, std::function<int()>& action);

}  // namespace foresight

// Which subcommands a program has: all_commands.cpp, or demo_commands.cpp for a first look.
#pragma once

#include "apps/command_line/command_line.hpp"

namespace foresight {

/// Each sets `action` to its work where the command line asks for it.
void add_commands(Command& app, std::function<int()>& action);

}  // namespace foresight

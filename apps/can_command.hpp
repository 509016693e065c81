// Command line of `foresight can`: looking at CAN buses and talking to them by hand.
#pragma once

#include <CLI/CLI.hpp>
#include <functional>

namespace foresight {

/// Adds the subcommand; when it is chosen, `action` becomes what main() is to run.
void add_can_command(CLI::App& app, std::function<int()>& action);

}  // namespace foresight

// Command line of `foresight replay`.
#pragma once

#include <CLI/CLI.hpp>
#include <functional>

namespace foresight {

/// Adds the subcommand; when it is chosen, `action` becomes what main() is to run.
void add_replay_command(CLI::App& app, std::function<int()>& action);

}  // namespace foresight

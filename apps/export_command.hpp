// The options of `foresight export`.
#pragma once

#include <CLI/CLI.hpp>
#include <functional>

namespace foresight {

/// Adds the subcommand; when it is given, `action` becomes what to do, returning the exit code.
void add_export_command(CLI::App& app, std::function<int()>& action);

}  // namespace foresight

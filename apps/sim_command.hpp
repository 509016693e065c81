#pragma once

#include <CLI/CLI.hpp>
#include <functional>

namespace foresight {

/// `foresight sim drives --can IF`: emulated drives on a CAN interface, for any master. When it is chosen, `action`
/// becomes what main() is to run.
void add_sim_command(CLI::App& app, std::function<int()>& action);

}  // namespace foresight

#pragma once

#include <CLI/CLI.hpp>
#include <functional>

namespace foresight {

/// `foresight record OUT [options]`: writes what two cameras deliver as a run. When it is chosen, `action` becomes
/// what main() is to run.
void add_record_command(CLI::App& app, std::function<int()>& action);

}  // namespace foresight

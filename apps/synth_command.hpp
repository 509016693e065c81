#pragma once

#include <CLI/CLI.hpp>
#include <functional>

namespace foresight {

/// `foresight synth OUT [options]`: writes a synthetic run with its truth. When it is chosen, `action`
/// becomes what main() is to run.
void add_synth_command(CLI::App& app, std::function<int()>& action);

}  // namespace foresight

#pragma once

#include <functional>

#include "apps/command_line/command_line.hpp"

namespace foresight {

/// `foresight synth OUT [options]`: writes a synthetic run with its truth. When it is chosen, `action`
/// becomes what main() is to run.
void add_synth_command(Command& app, std::function<int()>& action);

}  // namespace foresight

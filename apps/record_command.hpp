#pragma once

#include <functional>

#include "apps/command_line/command_line.hpp"

namespace foresight {

/// `foresight record OUT [options]`: writes what two cameras deliver as a run. When it is chosen, `action` becomes
/// what main() is to run.
void add_record_command(Command& app, std::function<int()>& action);

}  // namespace foresight

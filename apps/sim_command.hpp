#pragma once

#include <functional>

#include "apps/command_line/command_line.hpp"

namespace foresight {

/// `foresight sim drives --can IF`: emulated drives on a CAN interface, for any master. When it is chosen, `action`
/// becomes what main() is to run.
void add_sim_command(Command& app, std::function<int()>& action);

}  // namespace foresight

// `foresight link`: looks at a running line.
#pragma once

#include <functional>

#include "apps/command_line/command_line.hpp"

namespace foresight {

void add_link_command(Command& app, std::function<int()>& action);

struct LinkPlace;
/// The options that say where the line is, but for --rig. `place` must live as long as `command`.
void add_link_place(Command& command, LinkPlace& place);

}  // namespace foresight

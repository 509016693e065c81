// `foresight link`: looks at a running line.
#pragma once

#include <functional>

#include "apps/command_line/command_line.hpp"

namespace foresight {

void add_link_command(Command& app, std::function<int()>& action);

}  // namespace foresight

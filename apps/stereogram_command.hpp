#pragma once

#include <functional>

#include "apps/command_line/command_line.hpp"

namespace foresight {

/// `foresight stereogram`
void add_stereogram_command(Command& app, std::function<int()>& action);

}  // namespace foresight

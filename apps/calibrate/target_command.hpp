// `foresight calibrate target`: a board as PDF, and the check of its print.
#pragma once

#include <functional>

#include "apps/command_line/command_line.hpp"

namespace foresight {

void add_target(Command& calibrate, std::function<int()>& action);

}  // namespace foresight

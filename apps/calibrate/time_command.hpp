// `foresight calibrate time`.
#pragma once

#include <functional>

#include "apps/command_line/command_line.hpp"

namespace foresight {

void add_time(Command& calibrate, std::function<int()>& action);

}  // namespace foresight

// `foresight calibrate verify`.
#pragma once

#include <functional>

#include "apps/command_line/command_line.hpp"

namespace foresight {

void add_verify(Command& calibrate, std::function<int()>& action);

}  // namespace foresight

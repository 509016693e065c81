// `foresight calibrate display`: the lens of a head display from pictures taken through it.
#pragma once

#include <functional>

#include "apps/command_line/command_line.hpp"

namespace foresight {

void add_display(Command& calibrate, std::function<int()>& action);

}  // namespace foresight

// `foresight calibrate pan-tilt`.
#pragma once

#include <functional>

#include "apps/command_line/command_line.hpp"

namespace foresight {

void add_pan_tilt(Command& calibrate, std::function<int()>& action);

}  // namespace foresight

// `foresight calibrate stereo`.
#pragma once

#include <functional>

#include "apps/command_line/command_line.hpp"

namespace foresight {

void add_stereo(Command& calibrate, std::function<int()>& action);

}  // namespace foresight

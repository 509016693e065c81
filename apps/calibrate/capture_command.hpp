// `foresight calibrate capture`: takes pairs of images of a board from live cameras.
#pragma once

#include <functional>

#include "apps/command_line/command_line.hpp"

namespace foresight {

void add_capture(Command& calibrate, std::function<int()>& action);

}  // namespace foresight

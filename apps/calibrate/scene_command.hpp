// `foresight calibrate scene`: places a model in the world.
#pragma once

#include <functional>

#include "apps/command_line/command_line.hpp"

namespace foresight {

void add_scene(Command& calibrate, std::function<int()>& action);

}  // namespace foresight

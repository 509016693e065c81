// `foresight doctor`: what this machine can do, and what to type where something is missing.
#pragma once

#include <functional>

#include "apps/command_line/command_line.hpp"

namespace foresight {

void add_doctor_command(Command& app, std::function<int()>& action);

}  // namespace foresight

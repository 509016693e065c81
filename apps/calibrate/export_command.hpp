// `foresight calibrate export`: calibrated cameras in the files of other programs, and back.
#pragma once

#include <functional>

#include "apps/command_line/command_line.hpp"

namespace foresight {

void add_export(Command& calibrate, std::function<int()>& action);

}  // namespace foresight

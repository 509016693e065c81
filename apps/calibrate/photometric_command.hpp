// `foresight calibrate photometric`: response, vignetting and gain from exposure series.
#pragma once

#include <functional>

#include "apps/command_line/command_line.hpp"

namespace foresight {

void add_photometric(Command& calibrate, std::function<int()>& action);

}  // namespace foresight

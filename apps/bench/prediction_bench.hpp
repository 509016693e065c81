// `foresight bench prediction`: how well the robot that will be is predicted, a subcommand per question.
#pragma once

#include <functional>

#include "apps/command_line/command_line.hpp"

namespace foresight {

void add_prediction_benches(Command& bench, std::function<int()>& action);

}  // namespace foresight

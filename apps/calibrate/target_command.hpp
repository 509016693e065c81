// `foresight calibrate target`: a board as PDF, and the check of its print.
#pragma once

#include <CLI/CLI.hpp>
#include <functional>

namespace foresight {

void add_target(CLI::App& calibrate, std::function<int()>& action);

}  // namespace foresight

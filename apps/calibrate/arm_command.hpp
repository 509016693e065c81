// `foresight calibrate arm`.
#pragma once

#include <CLI/CLI.hpp>
#include <functional>

namespace foresight {

void add_arm(CLI::App& calibrate, std::function<int()>& action);

}  // namespace foresight

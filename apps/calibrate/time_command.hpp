// `foresight calibrate time`.
#pragma once

#include <CLI/CLI.hpp>
#include <functional>

namespace foresight {

void add_time(CLI::App& calibrate, std::function<int()>& action);

}  // namespace foresight

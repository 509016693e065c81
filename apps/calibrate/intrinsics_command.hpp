// `foresight calibrate intrinsics`.
#pragma once

#include <CLI/CLI.hpp>
#include <functional>

namespace foresight {

void add_intrinsics(CLI::App& calibrate, std::function<int()>& action);

}  // namespace foresight

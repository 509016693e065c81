// `foresight calibrate pan-tilt`.
#pragma once

#include <CLI/CLI.hpp>
#include <functional>

namespace foresight {

void add_pan_tilt(CLI::App& calibrate, std::function<int()>& action);

}  // namespace foresight

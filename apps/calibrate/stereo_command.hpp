// `foresight calibrate stereo`.
#pragma once

#include <CLI/CLI.hpp>
#include <functional>

namespace foresight {

void add_stereo(CLI::App& calibrate, std::function<int()>& action);

}  // namespace foresight

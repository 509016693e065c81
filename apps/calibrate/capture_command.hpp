// `foresight calibrate capture`: takes pairs of images of a board from live cameras.
#pragma once

#include <CLI/CLI.hpp>
#include <functional>

namespace foresight {

void add_capture(CLI::App& calibrate, std::function<int()>& action);

}  // namespace foresight

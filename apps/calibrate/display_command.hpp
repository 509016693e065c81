// `foresight calibrate display`: the lens of a head display from pictures taken through it.
#pragma once

#include <CLI/CLI.hpp>
#include <functional>

namespace foresight {

void add_display(CLI::App& calibrate, std::function<int()>& action);

}  // namespace foresight

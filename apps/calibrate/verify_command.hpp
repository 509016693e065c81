// `foresight calibrate verify`.
#pragma once

#include <CLI/CLI.hpp>
#include <functional>

namespace foresight {

void add_verify(CLI::App& calibrate, std::function<int()>& action);

}  // namespace foresight

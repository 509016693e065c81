// `foresight calibrate export`: calibrated cameras in the files of other programs, and back.
#pragma once

#include <CLI/CLI.hpp>
#include <functional>

namespace foresight {

void add_export(CLI::App& calibrate, std::function<int()>& action);

}  // namespace foresight

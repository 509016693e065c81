// `foresight calibrate COMMAND`: one file per command beside this one.
#pragma once

#include <CLI/CLI.hpp>
#include <functional>

namespace foresight {

void add_calibrate_command(CLI::App& app, std::function<int()>& action);

}  // namespace foresight

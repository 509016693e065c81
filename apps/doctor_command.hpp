// `foresight doctor`: what this machine can do, and what to type where something is missing.
#pragma once

#include <CLI/CLI.hpp>
#include <functional>

namespace foresight {

void add_doctor_command(CLI::App& app, std::function<int()>& action);

}  // namespace foresight

// `foresight calibrate scene`: places a model in the world.
#pragma once

#include <CLI/CLI.hpp>
#include <functional>

namespace foresight {

void add_scene(CLI::App& calibrate, std::function<int()>& action);

}  // namespace foresight

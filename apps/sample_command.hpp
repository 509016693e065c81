#pragma once

#include <CLI/CLI.hpp>
#include <functional>

namespace foresight {

/// `foresight sample OUT [--frames N] [--size WxH] [--stereo] [--no-distortion] [--seed N]`: writes the built-in run.
/// When it is chosen, `action` becomes what main() is to run.
void add_sample_command(CLI::App& app, std::function<int()>& action);

}  // namespace foresight

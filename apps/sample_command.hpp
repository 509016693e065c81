#pragma once

#include <CLI/App.hpp>

namespace foresight {

/// `foresight sample OUT [--frames N] [--size WxH] [--stereo] [--no-distortion] [--seed N]`: writes the built-in run.
void add_sample_command(CLI::App& app);

}  // namespace foresight

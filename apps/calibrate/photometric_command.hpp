// `foresight calibrate photometric`: response, vignetting and gain from exposure series.
#pragma once

#include <CLI/CLI.hpp>
#include <functional>

namespace foresight {

void add_photometric(CLI::App& calibrate, std::function<int()>& action);

}  // namespace foresight

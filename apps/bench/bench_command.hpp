// `foresight bench`: measurements that compare, each with a baseline in the same run.
#pragma once

#include <CLI/CLI.hpp>
#include <functional>

namespace foresight {

void add_bench_command(CLI::App& app, std::function<int()>& action);

}  // namespace foresight

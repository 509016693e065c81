// `foresight bench`: measurements that compare, each with a baseline in the same run.
#pragma once

#include <functional>

#include "apps/command_line/command_line.hpp"

namespace foresight {

void add_bench_command(Command& app, std::function<int()>& action);

}  // namespace foresight

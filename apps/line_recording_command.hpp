#pragma once

#include <functional>

#include "apps/command_line/command_line.hpp"

namespace foresight {

/// `foresight play FILE` and `foresight export-run FILE --out DIR`: recordings of `foresight record --line`. When one
/// is chosen, `action` becomes what main() is to run.
void add_line_recording_commands(Command& app, std::function<int()>& action);

}  // namespace foresight

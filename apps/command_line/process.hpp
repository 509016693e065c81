// What every program has to settle with the system before and after its work.
#pragma once

#include <functional>

namespace foresight {

/// Before anything is opened or a thread started. Streams that were closed cannot become somebody's file: stdin is
/// empty then, and what goes to stdout or stderr fails. A reader that has gone and a limit on the size of files are
/// errors of writing, no signals. Memory that is free goes back to the system. Stop signals end the program
/// (common/stop_signal.hpp) until work polls them. A thread that has no memory ends the program with a word and exit
/// code 1. A crash tells where it was (crash_report.hpp).
void settle_process();

/// Runs `work` and returns the exit code: its own; 2 for an InputError, 1 for any other failure, each told in one last
/// line on stderr; 1 also where not all that went to stdout could be written. What cannot be written to stderr is lost.
int exit_code_of(const std::function<int()>& work) noexcept;

}  // namespace foresight

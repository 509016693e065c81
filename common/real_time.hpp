// Asks the system for punctuality.
#pragma once

#include <string>

namespace foresight {

/// Gives the calling thread real-time priority (SCHED_FIFO). Where the system refuses, all is left as it was and the
/// answer says why and what to set; empty where it was granted.
std::string make_real_time(int priority);

/// Keeps the process's memory, present and future, out of reach of the swap. Takes a while. Answers as
/// make_real_time().
std::string lock_memory();

/// Gives the calling thread, and those that it starts from now on, less processor time than others get where all is
/// busy.
void make_background() noexcept;

}  // namespace foresight

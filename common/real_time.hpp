// Asks the system for punctuality.
#pragma once

#include <string>

namespace foresight {

/// Threads that motion waits for, in the order of their urgency; all are above the network's and the cameras' and below
/// the kernel's watchdogs.
namespace priority {
inline constexpr int kControlLoop = 80;  ///< of the robot
inline constexpr int kMockDrives = 70;   ///< real ones do not wait for this machine either
inline constexpr int kLine = 60;         ///< what commands and reports pass through, on either side
inline constexpr int kSeat = 50;         ///< what an operator's hand becomes
}  // namespace priority

/// Gives the calling thread real-time priority (SCHED_FIFO), 1 .. 99. Where the system refuses, all is left as it was
/// and the answer says why and what to set; empty where it was granted.
std::string make_real_time(int priority);

/// Keeps the process's memory, present and future, out of reach of the swap. Takes a while. Answers as
/// make_real_time().
std::string lock_memory();

/// Gives the calling thread, and those that it starts from now on, less processor time than others get where all is
/// busy.
void make_background() noexcept;

}  // namespace foresight

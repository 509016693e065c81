// Asks the system for punctuality.
#pragma once

#include <string>
#include <vector>

namespace foresight {

/// Gives the calling thread real-time priority (SCHED_FIFO) and locks the process's memory. What the system refuses
/// is left as it was; the answer has a sentence for each refusal, with what to set, and is empty where all was granted.
std::vector<std::string> make_real_time(int priority);

}  // namespace foresight

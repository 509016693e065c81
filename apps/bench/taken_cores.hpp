// Time in which the scheduler gave the cores to other programs.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "common/unique_fd.hpp"

namespace foresight {

/// Of the calling thread, and of those of this process that it waits for. Linux: /proc/self/task/*/schedstat; where the
/// kernel does not tell, nothing was taken.
class TakenCores {
 public:
  /// `helpers`: what the names of the other threads begin with. Threads that begin later are not seen.
  explicit TakenCores(const std::string& helpers);

  /// Seconds since the last call, or the first, in which a thread could have run and did not: the calling one's, and
  /// the most of any helper's. Counts only what this process did not use itself: a core that it keeps busy is its own.
  double since_last();

 private:
  struct Thread {
    UniqueFd file;
    double waited_s = 0;
  };
  std::vector<Thread> threads_;  // the calling one first
  double wall_s_ = 0, cpu_s_ = 0;
  double cores_ = 1;
};

}  // namespace foresight

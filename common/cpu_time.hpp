// CPU time, for benches and reports.
#pragma once

#include <ctime>

namespace foresight {

/// Seconds of CPU time on `clock`: CLOCK_PROCESS_CPUTIME_ID, CLOCK_THREAD_CPUTIME_ID, or another thread's
/// (pthread_getcpuclockid). 0 where the clock is gone, such as that of a thread that has ended.
inline double cpu_seconds(clockid_t clock) noexcept {
  timespec t{};
  if (clock_gettime(clock, &t) != 0) return 0;
  return static_cast<double>(t.tv_sec) + static_cast<double>(t.tv_nsec) * 1e-9;
}

}  // namespace foresight

#include "common/real_time.hpp"

#include <pthread.h>
#include <sys/mman.h>
#include <sys/resource.h>
#include <unistd.h>

#include <cstring>

namespace foresight {

std::string make_real_time(int priority) {
  sched_param parameters{};
  parameters.sched_priority = priority;
  const int error = pthread_setschedparam(pthread_self(), SCHED_FIFO, &parameters);
  if (error == 0) return {};
  return "no real-time priority (" + std::string(std::strerror(error)) +
         "): add '@realtime - rtprio 90' to /etc/security/limits.conf and yourself to the group realtime, or "
         "LimitRTPRIO=90 to the systemd unit";
}

std::string lock_memory() {
  rlimit most{};
  getrlimit(RLIMIT_MEMLOCK, &most);
  // With a limit, MCL_FUTURE would make later allocations fail.
  const bool unlimited = most.rlim_cur == RLIM_INFINITY || geteuid() == 0;
  if (unlimited && mlockall(MCL_CURRENT | MCL_FUTURE) == 0) return {};
  return "memory is not locked: add '@realtime - memlock unlimited' to /etc/security/limits.conf, or "
         "LimitMEMLOCK=infinity to the systemd unit";
}

void make_background() noexcept {
  constexpr int kNiceness = 10;             // about a tenth of a normal thread's share
  setpriority(PRIO_PROCESS, 0, kNiceness);  // of this thread alone, under Linux
}

}  // namespace foresight

#include "common/suspension.hpp"

#include <algorithm>
#include <ctime>

namespace foresight {
namespace {

Duration read(clockid_t clock) noexcept {
  timespec t{};
  clock_gettime(clock, &t);
  return std::chrono::seconds(t.tv_sec) + std::chrono::nanoseconds(t.tv_nsec);
}

}  // namespace

Duration SuspensionWatch::machine_asleep() noexcept {
  // Whoever is interrupted between the two would see a sleep: of a few tries, the shortest counts.
  Duration shortest = Duration::max();
  for (int i = 0; i < 3; ++i) {
    const Duration monotonic = read(CLOCK_MONOTONIC);
    shortest = std::min(shortest, read(CLOCK_BOOTTIME) - monotonic);
  }
  return shortest;
}

}  // namespace foresight

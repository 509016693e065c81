#include "drivers/can/receive_time.hpp"

#include <algorithm>
#include <ctime>
#include <utility>

namespace foresight {
namespace {

Duration read_clock(clockid_t clock) {
  timespec t{};
  clock_gettime(clock, &t);
  return std::chrono::seconds(t.tv_sec) + std::chrono::nanoseconds(t.tv_nsec);
}

}  // namespace

Duration realtime_minus_monotonic(int tries) noexcept {
  Duration best{0}, tightest = Duration::max();
  for (int i = 0; i < tries; ++i) {
    const Duration before = read_clock(CLOCK_MONOTONIC);
    const Duration real = read_clock(CLOCK_REALTIME);
    const Duration after = read_clock(CLOCK_MONOTONIC);
    if (after - before >= tightest) continue;
    tightest = after - before;
    best = real - (before + (after - before) / 2);
  }
  return best;
}

Duration DeviceClockOffset::to_kernel(Duration device, Duration kernel) noexcept {
  constexpr Duration kHalf = std::chrono::seconds(10), kLatest = std::chrono::seconds(1);
  const Duration difference = kernel - device;
  // A clock that was set, or a controller that was restarted, makes the past worthless; no interrupt is that late.
  const bool jumped = smallest_ != kNone && (difference < smallest_ - kLatest || difference > smallest_ + kLatest);
  if (start_ == kNone || jumped) {
    start_ = kernel;
    smallest_ = before_ = kNone;
  } else if (kernel - start_ > kHalf) {
    start_ = kernel;
    before_ = std::exchange(smallest_, kNone);
  }
  smallest_ = std::min(smallest_, difference);
  return device + std::min(smallest_, before_);
}

}  // namespace foresight

// Instants of the monotonic clock as unix time, for ROS 2's stamps.
#pragma once

#include <atomic>
#include <functional>

#include "common/clock.hpp"

namespace foresight::link {

/// Follows the machine's wall clock in steps of a millisecond or more, so that stamps of one instant are the same on
/// all topics, and a clock that is set right is followed. Any thread.
class WallClock {
 public:
  /// `now_unix_ns`: the wall clock; the machine's by default.
  using Now = std::function<std::int64_t()>;
  explicit WallClock(const Clock& clock, Now now_unix_ns = machine_unix_ns)
      : clock_(clock), now_unix_ns_(std::move(now_unix_ns)), offset_ns_(measured()) {}

  std::int64_t unix_ns(RobotTime time) {
    constexpr std::int64_t kStep = 1'000'000;
    const std::int64_t now = measured(), used = offset_ns_.load(std::memory_order_relaxed);
    if (now - used > kStep || used - now > kStep) offset_ns_.store(now, std::memory_order_relaxed);
    return time.ns + offset_ns_.load(std::memory_order_relaxed);
  }
  static std::int64_t machine_unix_ns() noexcept {
    return std::chrono::duration_cast<Duration>(std::chrono::system_clock::now().time_since_epoch()).count();
  }

 private:
  std::int64_t measured() const { return now_unix_ns_() - clock_.now().ns; }

  const Clock& clock_;
  Now now_unix_ns_;
  std::atomic<std::int64_t> offset_ns_;
};

}  // namespace foresight::link

// Whether the machine was suspended.
#pragma once

#include <functional>

#include "common/time.hpp"

namespace foresight {

/// A suspended machine's monotonic clock stands still: afterwards all that was under way looks fresh to it. One thread.
class SuspensionWatch {
 public:
  /// For how long the machine was suspended since it was started; the machine's own by default.
  using Asleep = std::function<Duration()>;
  explicit SuspensionWatch(Asleep asleep = machine_asleep) : asleep_(std::move(asleep)), known_(asleep_()) {}

  /// Once after each suspension of 10 ms or more.
  bool woke() {
    const Duration now = asleep_();
    if (now - known_ < std::chrono::milliseconds(10)) return false;
    known_ = now;
    return true;
  }

  /// CLOCK_BOOTTIME, which goes on, less CLOCK_MONOTONIC (clock_gettime(2)).
  static Duration machine_asleep() noexcept;

 private:
  Asleep asleep_;
  Duration known_;
};

}  // namespace foresight

// Whether the machine was suspended.
#pragma once

#include <functional>
#include <optional>

#include "common/time.hpp"

namespace foresight {

/// A suspended machine's monotonic clock stands still: afterwards all that was under way looks fresh to it. One thread.
class SuspensionWatch {
 public:
  /// For how long the machine was suspended since it was started; the machine's own by default.
  using Asleep = std::function<Duration()>;
  explicit SuspensionWatch(Asleep asleep = machine_asleep) : asleep_(std::move(asleep)), known_(asleep_()) {}

  /// How long a suspension of 10 ms or more took; once after each.
  std::optional<Duration> woke() {
    const Duration now = asleep_(), lasted = now - known_;
    if (lasted < std::chrono::milliseconds(10)) return std::nullopt;
    known_ = now;
    return lasted;
  }

  /// CLOCK_BOOTTIME, which goes on, less CLOCK_MONOTONIC (clock_gettime(2)).
  static Duration machine_asleep() noexcept;

 private:
  Asleep asleep_;
  Duration known_;
};

}  // namespace foresight

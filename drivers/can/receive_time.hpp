// When a frame was received, on our clock, from the stamps of other clocks.
#pragma once

#include "common/time.hpp"

namespace foresight {

/// CLOCK_REALTIME minus CLOCK_MONOTONIC, measured now (the tightest of `tries`). Changes when
/// somebody sets the machine's clock. About 0.1 us per try, any thread.
Duration realtime_minus_monotonic(int tries = 3) noexcept;

/// Learns how far a controller's own clock is ahead of the kernel's from pairs of stamps. The kernel's
/// stamp is late by the interrupt's delay, never early, so the smallest difference of the last 10 to
/// 20 s is the closest; it follows a drift of 50 ppm within 1 ms. One thread.
class DeviceClockOffset {
 public:
  /// `device`: since the controller's own epoch. `kernel`: CLOCK_REALTIME since its epoch. Returns
  /// `device` on CLOCK_REALTIME, never later than `kernel`.
  Duration to_kernel(Duration device, Duration kernel) noexcept;

 private:
  static constexpr Duration kNone = Duration::max();
  Duration start_ = kNone;                      // of the present half of the window
  Duration smallest_ = kNone, before_ = kNone;  // kernel - device: of this half, of the half before
};

}  // namespace foresight

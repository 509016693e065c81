// Where "now" comes from: the machine's monotonic clock, or a clock that a test moves on by hand.
#pragma once

#include <functional>
#include <vector>

#include "common/time.hpp"

namespace foresight {

/// Whatever waits or stamps takes its time from here, so that the same program runs in real time
/// and, deterministically, in stepped time.
class Clock {
 public:
  virtual ~Clock() = default;
  /// Never goes back. Any thread.
  virtual RobotTime now() const noexcept = 0;
  /// Returns at `time` or later; at once where it has passed. Must not be interrupted by signals.
  virtual void sleep_until(RobotTime time) noexcept = 0;
};

/// CLOCK_MONOTONIC, which V4L2 and our CAN drivers stamp with too. Stateless.
class MonotonicClock final : public Clock {
 public:
  RobotTime now() const noexcept override;
  void sleep_until(RobotTime time) noexcept override;
};

/// Time that passes only while someone waits for it. What happens in it are periodic tasks (an
/// emulated drive's control cycle, a bus that delivers) which run, in the order of their instants
/// and then of their registration, inside of the wait. One thread.
class SteppedClock final : public Clock {
 public:
  /// Calls `task(now)` at now + period, now + 2 periods and so on. `period` > 0. Tasks must not wait.
  void every(Duration period, std::function<void(RobotTime)> task);

  RobotTime now() const noexcept override { return now_; }
  void sleep_until(RobotTime time) noexcept override;
  /// To the next task's instant, which then has run, or to `limit`, whichever comes first. What
  /// waits for an event calls this until the event is there.
  void step_towards(RobotTime limit) noexcept;

 private:
  struct Task {
    RobotTime next;
    Duration period;
    std::function<void(RobotTime)> run;
  };
  RobotTime now_;
  std::vector<Task> tasks_;
};

}  // namespace foresight

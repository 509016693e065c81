// How fast the line carries, from when packets were sent and when they came.
//
// Between two arrivals the line was busy if the later packet had been sent long enough before to be waiting when the
// earlier one came: only such times tell what the line can carry, all others what it was given.
#pragma once

#include <deque>
#include <optional>

#include "common/time.hpp"

namespace foresight {

/// One thread. The two clocks may have any offset.
class RateMeter {
 public:
  /// A packet that was sent at `sent` came at `arrived` of the receiver's clock. One that came before an earlier
  /// one of these is of no use.
  void add(RobotTime sent, Duration arrived, std::size_t bytes);

  /// Bytes per second that the line may be trusted to carry next: what it carried while it was busy, over the last
  /// 250 ms of busy time or over the last 80 ms, whichever is less, as lines get slower without a word. `overdue`: for
  /// how long packets that are on their way should have come by now; it counts as busy time in which nothing came.
  /// Nothing before the line was busy at all.
  std::optional<double> rate(Duration overdue = {}) const;

 private:
  struct Stretch {
    Duration lasted;
    std::size_t bytes;
  };
  Duration least_way() const;

  std::optional<Duration> last_;  // arrival
  std::deque<Stretch> busy_;
  Duration busy_time_{};
  std::size_t busy_bytes_ = 0;
  std::optional<Duration> least_[2];  // smallest arrived - sent, of this and the previous half minute
  RobotTime least_since_{};
};

}  // namespace foresight

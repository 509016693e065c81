// How fast the line carries, from when packets were sent and when they came.
//
// Between two arrivals the line was busy if the later packet had been sent long enough before to be waiting when the
// earlier one came: only such times tell what the line can carry, all others what it was given.
//
// Long enough is judged by the least way of late. Where the road itself has become longer, everything would seem to
// wait from then on. But packets that leave together come apart by what the line takes for each: where that is a
// fraction of the time between what it is given, nothing waits, and the least way is that of the last second.
#pragma once

#include <deque>
#include <optional>

#include "common/time.hpp"

namespace foresight {

/// One thread. The two clocks may have any offset.
class RateMeter {
 public:
  /// A packet that was sent at `sent` came at `arrived` of the receiver's clock. One that came before an earlier
  /// one of these is of no use. True where a second is over in which the line could have carried several times what it
  /// was given: what took longer in all of that second than before went a longer road, and did not wait.
  bool add(RobotTime sent, Duration arrived, std::size_t bytes);

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
  struct Second {
    RobotTime begin;
    std::size_t bytes = 0;
    std::size_t bytes_behind = 0;  // of packets that left together with the one before,
    Duration behind{};             // and by what they came later
    std::optional<Duration> least_way = {};
  };
  Duration least_way() const;
  bool end_second(RobotTime now);

  std::optional<Duration> last_;  // arrival
  RobotTime last_sent_;
  Second second_;
  std::deque<Stretch> busy_;
  Duration busy_time_{};
  std::size_t busy_bytes_ = 0;
  std::optional<Duration> least_[2];  // smallest arrived - sent, of this and the previous half minute
  RobotTime least_since_{};
};

}  // namespace foresight

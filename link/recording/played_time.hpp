// What instants of a recording are while it is played.
#pragma once

#include <optional>

#include "common/time.hpp"

namespace foresight::link {

/// Moves all instants by the same, and stretches what lies between them where the rate is not 1: stamps that were equal
/// stay equal on all topics, and what was sent so long after its capture is so again. Messages go by when they were
/// written; where the writer's wall clock was set meanwhile, by when they came. Takes any numbers. One thread.
class PlayedTime {
 public:
  /// The first message goes at `start`, which is `start_unix_ns` on the wall clock here. `rate` 0.01 .. 100.
  PlayedTime(RobotTime start, std::int64_t start_unix_ns, double rate);

  /// When a message goes; in the order of the recording, never before the one before it. `kept`: its topic's newest
  /// message goes to who comes late: it may have been written long before it came.
  RobotTime due(std::int64_t log_ns, std::int64_t publish_ns, bool kept);

  /// An instant that the robot's clocks told both ways. `exact`: they are certainly the same instant.
  void learn(std::int64_t unix_ns, std::int64_t monotonic_ns, bool exact);

  std::int64_t unix_ns(std::int64_t recorded_unix_ns) const;
  /// Of the robot's monotonic clock, in which nothing was learned before: as it is.
  std::int64_t monotonic_ns(std::int64_t recorded_ns) const;

 private:
  struct Last {
    std::int64_t log_ns, publish_ns;
  };
  Duration stretched(std::int64_t from_ns, std::int64_t to_ns) const;

  RobotTime start_, anchor_, last_due_;  // `anchor_`: when what was written at publish_ns_ goes
  std::int64_t start_unix_ns_ = 0, publish_ns_ = 0;
  double rate_ = 1;
  std::optional<Last> last_;
  std::optional<std::int64_t> unix_minus_monotonic_;
  bool exact_ = false;
};

}  // namespace foresight::link

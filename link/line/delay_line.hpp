// One direction of a line, as pure logic: when does a packet that is sent now arrive, if at all.
//
//   sent --> lost? --> bottleneck: waits its turn --> way: delay, recorded delay, jitter --> arrived
//
// The same spec, seed and packets give the same arrivals, bit for bit, in stepped time and in real time.
#pragma once

#include <optional>
#include <random>

#include "link/line/bottleneck.hpp"

namespace foresight {

/// One thread.
class DelayLine {
 public:
  /// `begin`: when traces and outages begin. `spec` was checked (check(DirectionSpec)).
  DelayLine(const DirectionSpec& spec, RobotTime begin, std::uint64_t seed);

  /// A packet of `bytes` is sent at `now`, which is not before `begin` and never goes back: when it arrives, or nothing
  /// where it is lost.
  std::optional<RobotTime> send(RobotTime now, std::size_t bytes);

  /// Draws whether the packet just sent arrives a second time.
  bool duplicated();

  /// When a packet that is sent at `sent` would arrive if there were no others, no drawn jitter and no drawn loss;
  /// nothing where the recording lost it. Changes nothing.
  std::optional<RobotTime> idle_arrival(RobotTime sent, std::size_t bytes) const;

  /// Bytes that the bottleneck can carry in this time; infinite where there is none.
  double capacity(RobotTime from, RobotTime to) const { return bottleneck_.capacity(from - begin_, to - begin_); }

 private:
  double uniform();  // [0, 1)
  bool drawn_loss();
  struct Fate {
    Duration delay{};
    bool lost = false;
  };
  Fate recorded(Duration at) const;

  DirectionSpec spec_;
  RobotTime begin_;
  std::mt19937_64 random_;
  Bottleneck bottleneck_;
  std::vector<Outage> losing_;
  bool bad_ = false;    // Gilbert's state
  Duration arrived_{};  // the last that may not be overtaken
};

}  // namespace foresight

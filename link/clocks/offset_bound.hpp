// How far the clock of another host is ahead of ours, and how sure that is.
//
//   here   --sent----------------------returned-->      A ping arrives after it was sent, and its answer too:
//               \                     /                   answered - returned  <=  offset  <=  received - sent
//   there  ------received----answered------------>      The truth is between; where, no stamp can tell: a line may
//                                                       be slower in one direction.
//
// Each bound holds at its own instant and gets wider with time by what the clocks may drift apart. Those of many round
// trips are intersected: the smallest delay of either direction counts, whenever it occurred (K. Marzullo, "Maintaining
// the time in a distributed system", 1984; the drift as in S. Moon et al., "Estimation and removal of clock skew from
// network delay measurements", 1999).
#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "link/clocks/drift_estimate.hpp"

namespace foresight {

/// The stamps of one ping and its answer, ns: `sent` and `returned` by our clock, the others by the other host's.
struct Exchange {
  std::int64_t sent = 0, received = 0, answered = 0, returned = 0;
};

/// The other clock minus ours, ns: not less than `least`, not more than `most`.
struct OffsetInterval {
  std::int64_t least = 0, most = 0;
  std::int64_t middle() const { return least + (most - least) / 2; }
  /// The middle is off by this much at most.
  std::int64_t half() const { return most - middle(); }
};

/// What a new stamp has shown.
enum class ClockNews : std::uint8_t {
  fine,
  nonsense,  ///< stamps that no line can make: not used
  stale,     ///< begun before the last jump: not used
  doubted,   ///< does not fit what was known, by little, or fits only by chance: it starts anew, with wider bounds
  jumped,    ///< one of the clocks has jumped, or stood still while its host was suspended: it starts anew
};

/// One thread; does not allocate but once a second, when it learns the drift. Everything is judged by the stamps alone.
class OffsetBound {
 public:
  /// Of one clock against the other: quartz oscillators stay within. What drifts more ends in `doubted` again and
  /// again.
  static constexpr double kMostDrift = 60e-6;

  ClockNews add(const Exchange& exchange);

  /// At an instant of our clock, of the past or the future; nothing before the first exchange.
  std::optional<OffsetInterval> at(std::int64_t here) const;
  /// At an instant of the other's.
  std::optional<OffsetInterval> at_there(std::int64_t there) const;
  DriftInterval drift() const { return drift_; }
  std::uint64_t jumps() const { return jumps_; }

 private:
  /// A bound that held at some instant of our clock between `from` and `to`.
  struct Bound {
    std::int64_t offset = 0, from = 0, to = 0;
  };
  /// The tightest of one second.
  struct Bucket {
    std::int64_t second = 0;
    Bound upper, lower;
  };
  static constexpr std::size_t kBuckets = 128;  // seconds in which something arrived

  std::int64_t upper_at(std::int64_t here, const DriftInterval& drift, std::int64_t older_than) const;
  std::int64_t lower_at(std::int64_t here, const DriftInterval& drift, std::int64_t older_than) const;
  ClockNews judge(const Bound& upper, const Bound& lower) const;
  bool has_moved(std::int64_t here) const;
  void start_anew(ClockNews why, std::int64_t now);
  void keep(const Bound& upper, const Bound& lower, std::int64_t now);
  void learn_drift();

  std::array<Bucket, kBuckets> buckets_{};  // a ring
  std::size_t count_ = 0, newest_ = 0;
  std::int64_t valid_since_ = INT64_MIN;
  DriftInterval drift_{-kMostDrift, kMostDrift};
  std::uint64_t jumps_ = 0;
};

}  // namespace foresight

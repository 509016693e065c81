// The narrowest place of a line: when it has carried a packet, while others wait.
#pragma once

#include <deque>
#include <memory>
#include <vector>

#include "link/line/line_spec.hpp"

namespace foresight {

/// The instant of what never happens: the line is dead from now on.
inline constexpr Duration kNever = Duration::max() / 4;

/// Carries packets one after the other. Instants count from the line's begin. One thread.
class Bottleneck {
 public:
  /// Keeps the parts of `spec` that concern it: trace of chances or rates, rate, outages that hold, queue.
  explicit Bottleneck(const DirectionSpec& spec);

  /// Whether `bytes` that come at `at` find room in the queue. `at` never goes back.
  bool has_room(Duration at, std::size_t bytes);
  /// When the last of `bytes` that come at `at` has crossed; kNever where outages leave no time for it.
  Duration carry(Duration at, std::size_t bytes);
  /// The same for a packet that comes while nothing waits; changes nothing.
  Duration carry_alone(Duration at, std::size_t bytes) const;
  /// Bytes that would cross between two instants if there were always some.
  double capacity(Duration from, Duration to) const;

 private:
  struct Place {             // how far the line has come
    Duration at{};           // the last chance or byte
    std::size_t left = 0;    // bytes of that chance
    std::uint64_t next = 0;  // chance, counted through all periods
  };
  Duration carry_by_chances(Place& place, Duration at, std::size_t bytes) const;
  Duration carry_by_rate(Place& place, Duration at, std::size_t bytes) const;
  Duration carry(Place& place, Duration at, std::size_t bytes) const;
  Duration chance_at(std::uint64_t chance) const;
  std::uint64_t first_chance(Duration at) const;
  struct Stretch {
    double bytes_per_s;
    Duration end;
  };
  Stretch stretch(Duration at) const;
  Stretch stretch_of_trace(Duration at) const;

  std::shared_ptr<const Trace> trace_;
  double bytes_per_s_;
  std::size_t queue_bytes_;
  std::vector<Outage> outages_;
  Place place_;
  struct Waiting {
    Duration crossed;
    std::size_t bytes;
  };
  std::deque<Waiting> waiting_;
  std::size_t waiting_bytes_ = 0;
};

/// When no outage is left of those in which `at` lies, one after the other; `at` itself where it lies in none.
Duration end_of_outage(const std::vector<Outage>& outages, Duration at);

}  // namespace foresight

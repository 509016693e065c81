// Instants of another host's clock on ours, and back.
#pragma once

#include <array>
#include <optional>

#include "common/time.hpp"
#include "link/clocks/offset_bound.hpp"

namespace foresight {

/// An instant, and by how much it may be wrong in either direction.
template <typename Clock>
struct BoundedTime {
  Time<Clock> time;
  Duration uncertainty{0};
  Time<Clock> earliest() const { return time - uncertainty; }
  Time<Clock> latest() const { return time + uncertainty; }
};

/// How long something was on its way, and by how much that may be wrong in either direction. A line whose one direction
/// is slower by an unknown part has that part in `uncertainty`, so that `delay` may come out below 0 by as much.
struct BoundedDelay {
  Duration delay{0}, uncertainty{0};
};

struct ClockPing {
  std::uint64_t number = 0;
};

/// The answer, by the clock of who answers, ns.
struct ClockPong {
  std::uint64_t number = 0;
  std::int64_t received_ns = 0, answered_ns = 0;
};

/// `Here` is our clock, `There` the other host's. Both sides ping, and each answers the other's pings at once. One
/// thread.
template <typename Here, typename There>
class ClockTracker {
 public:
  static constexpr Duration kEvery = std::chrono::milliseconds(100);  ///< a ping

  /// `first`: a random number, so that answers to pings of another start are known as such.
  explicit ClockTracker(std::uint64_t first = 1) : next_(first), first_(first) {}

  /// The next ping, where one is due.
  std::optional<ClockPing> ping(Time<Here> now) {
    if (next_ != first_ && now < pinged_ + kEvery) return std::nullopt;
    pinged_ = now;
    sent_[next_ % kPending] = {next_, now, true};
    return ClockPing{next_++};
  }
  /// To a ping from there, which came and is answered now.
  static ClockPong answer(const ClockPing& ping, Time<Here> now) { return {ping.number, now.ns, now.ns}; }
  /// Each answer counts once; to a ping that is not known (any more) it is `stale`.
  ClockNews pong(const ClockPong& pong, Time<Here> now) {
    Sent& sent = sent_[pong.number % kPending];
    if (!sent.waits || sent.number != pong.number) return ClockNews::stale;
    sent.waits = false;
    const ClockNews news = bound_.add({sent.at.ns, pong.received_ns, pong.answered_ns, now.ns});
    if (news != ClockNews::nonsense) round_trip_ = now - sent.at - Duration{pong.answered_ns - pong.received_ns};
    return news;
  }

  /// Nothing before the first round trip, or of an instant that no clock shows.
  std::optional<BoundedTime<Here>> to_here(Time<There> there) const {
    const auto offset = bound_.at_there(there.ns);
    if (!offset) return std::nullopt;
    return BoundedTime<Here>{{there.ns - offset->middle()}, Duration{offset->half()}};
  }
  std::optional<BoundedTime<There>> to_there(Time<Here> here) const {
    const auto offset = bound_.at(here.ns);
    if (!offset) return std::nullopt;
    return BoundedTime<There>{{here.ns + offset->middle()}, Duration{offset->half()}};
  }
  /// Of what was sent there and has arrived here.
  std::optional<BoundedDelay> delay(Time<There> sent, Time<Here> arrived) const {
    const auto from = to_here(sent);
    if (!from) return std::nullopt;
    return BoundedDelay{arrived - from->time, from->uncertainty};
  }
  const OffsetBound& bound() const { return bound_; }
  /// Of the last answer, without the time that answering took; by what the other host says of that.
  std::optional<Duration> round_trip() const { return round_trip_; }

 private:
  static constexpr std::size_t kPending = 128;  // of pings: 12.8 s of round trip
  struct Sent {
    std::uint64_t number = 0;
    Time<Here> at;
    bool waits = false;
  };
  std::array<Sent, kPending> sent_{};
  std::uint64_t next_, first_;
  Time<Here> pinged_;
  std::optional<Duration> round_trip_;
  OffsetBound bound_;
};

}  // namespace foresight

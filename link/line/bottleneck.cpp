#include "link/line/bottleneck.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

namespace foresight {
namespace {

constexpr int kPatience = 10'000'000;  // steps without getting a packet across, after which a line counts as dead

/// The instant of an outage's last begin at or before `at`.
std::optional<Duration> last_begin(const Outage& outage, Duration at) {
  if (at < outage.at) return std::nullopt;
  return outage.every.count() > 0 ? outage.at + (at - outage.at) / outage.every * outage.every : outage.at;
}

/// The next begin after `at`.
Duration next_begin(const Outage& outage, Duration at) {
  if (at < outage.at) return outage.at;
  return outage.every.count() > 0 ? *last_begin(outage, at) + outage.every : kNever;
}

}  // namespace

Duration end_of_outage(const std::vector<Outage>& outages, Duration at) {
  Duration end = at;
  for (bool further = true; further && end < kNever;) {
    further = false;
    for (const Outage& outage : outages) {
      const std::optional<Duration> begin = last_begin(outage, end);
      if (!begin || *begin + outage.lasts <= end) continue;
      end = *begin + outage.lasts;
      further = true;
    }
    // Outages that take turns may cover all time; whoever asks sees a line that never comes back.
    if (end - at > seconds(1e7)) end = kNever;
  }
  return end;
}

Bottleneck::Bottleneck(const DirectionSpec& spec)
    : trace_(spec.trace), bytes_per_s_(spec.bytes_per_s), queue_bytes_(spec.queue_bytes) {
  if (trace_ && std::holds_alternative<PacketTrace>(*trace_)) trace_.reset();
  std::copy_if(spec.outages.begin(), spec.outages.end(), std::back_inserter(outages_),
               [](const Outage& outage) { return !outage.loses; });
}

bool Bottleneck::has_room(Duration at, std::size_t bytes) {
  while (!waiting_.empty() && waiting_.front().crossed <= at) {
    waiting_bytes_ -= waiting_.front().bytes;
    waiting_.pop_front();
  }
  return queue_bytes_ == 0 || waiting_bytes_ + bytes <= queue_bytes_;
}

Duration Bottleneck::carry(Duration at, std::size_t bytes) {
  const Duration crossed = carry(place_, at, bytes);
  if (queue_bytes_ > 0) {
    waiting_.push_back({crossed, bytes});
    waiting_bytes_ += bytes;
  }
  return crossed;
}

Duration Bottleneck::carry_alone(Duration at, std::size_t bytes) const {
  Place place;
  return carry(place, at, bytes);
}

Duration Bottleneck::carry(Place& place, Duration at, std::size_t bytes) const {
  if (trace_ && std::holds_alternative<DeliveryTrace>(*trace_)) return carry_by_chances(place, at, bytes);
  if (trace_ || bytes_per_s_ > 0) return carry_by_rate(place, at, bytes);
  place.at = end_of_outage(outages_, std::max(at, place.at));
  return place.at;
}

Duration Bottleneck::chance_at(std::uint64_t chance) const {
  const std::vector<std::uint32_t>& at_ms = std::get<DeliveryTrace>(*trace_).at_ms;
  return std::chrono::milliseconds(chance / at_ms.size() * at_ms.back() + at_ms[chance % at_ms.size()]);
}

std::uint64_t Bottleneck::first_chance(Duration at) const {
  const std::vector<std::uint32_t>& at_ms = std::get<DeliveryTrace>(*trace_).at_ms;
  const std::int64_t ms = (at.count() + 999'999) / 1'000'000;
  // The end of a period and the begin of the next are the same millisecond: its own chances come first.
  const std::int64_t round = std::max<std::int64_t>(0, (ms - 1) / at_ms.back());
  const auto within = static_cast<std::uint32_t>(ms - round * at_ms.back());
  const auto first = std::lower_bound(at_ms.begin(), at_ms.end(), within);
  return static_cast<std::uint64_t>(round) * at_ms.size() + static_cast<std::uint64_t>(first - at_ms.begin());
}

Duration Bottleneck::carry_by_chances(Place& place, Duration at, std::size_t bytes) const {
  for (int in_vain = 0; in_vain < kPatience; ++in_vain) {
    if (place.left > 0 && place.at >= at) {
      const std::size_t taken = std::min(place.left, bytes);
      place.left -= taken;
      bytes -= taken;
      if (bytes == 0) return place.at;
      in_vain = 0;
    }
    const Duration from = end_of_outage(outages_, std::max(at, place.at));
    if (from >= kNever) break;
    const std::uint64_t chance = std::max(place.next, first_chance(from));
    place.next = chance + 1;
    place.at = chance_at(chance);
    place.left = end_of_outage(outages_, place.at) == place.at ? kChanceBytes : 0;
  }
  return place.at = kNever;
}

Bottleneck::Stretch Bottleneck::stretch_of_trace(Duration at) const {
  if (!trace_) return {bytes_per_s_, Duration::max()};
  const auto& trace = std::get<RateTrace>(*trace_);
  const Duration round = at / trace.period * trace.period;
  const auto next = std::upper_bound(trace.at.begin(), trace.at.end(), at - round);
  const auto index = static_cast<std::size_t>(next - trace.at.begin()) - 1;
  return {trace.bytes_per_s[index], round + (next == trace.at.end() ? trace.period : *next)};
}

Bottleneck::Stretch Bottleneck::stretch(Duration at) const {
  const Duration end = end_of_outage(outages_, at);
  if (end > at) return {0, end};
  Stretch here = stretch_of_trace(at);
  for (const Outage& outage : outages_) here.end = std::min(here.end, next_begin(outage, at));
  return here;
}

Duration Bottleneck::carry_by_rate(Place& place, Duration at, std::size_t bytes) const {
  Duration now = std::max(at, place.at);
  double left = static_cast<double>(bytes);
  // However little each stretch carries, a packet that needs so many of them is one that nobody waits for.
  for (int stretches = 0; stretches < kPatience && now < kNever; ++stretches) {
    const Stretch here = stretch(now);
    const double share = here.bytes_per_s > 0 ? left / here.bytes_per_s : INFINITY;
    if (share < to_seconds(here.end - now)) return place.at = now + seconds(share);
    left -= here.bytes_per_s * to_seconds(here.end - now);
    now = here.end;
  }
  return place.at = kNever;
}

double Bottleneck::capacity(Duration from, Duration to) const {
  double bytes = 0;
  if (trace_ && std::holds_alternative<DeliveryTrace>(*trace_)) {
    for (std::uint64_t chance = first_chance(from); chance_at(chance) < to; ++chance)
      if (const Duration at = chance_at(chance); end_of_outage(outages_, at) == at) bytes += kChanceBytes;
    return bytes;
  }
  if (!trace_ && bytes_per_s_ <= 0) return INFINITY;
  for (Duration now = from; now < to;) {
    const Stretch here = stretch(now);
    const Duration end = std::min(here.end, to);
    bytes += here.bytes_per_s * to_seconds(end - now);
    now = end;
  }
  return bytes;
}

}  // namespace foresight

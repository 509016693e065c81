#include "link/line/delay_line.hpp"

#include <algorithm>

namespace foresight {

DelayLine::DelayLine(const DirectionSpec& spec, RobotTime begin, std::uint64_t seed)
    : spec_(spec), begin_(begin), random_(seed), bottleneck_(spec) {
  std::copy_if(spec_.outages.begin(), spec_.outages.end(), std::back_inserter(losing_),
               [](const Outage& outage) { return outage.loses; });
}

double DelayLine::uniform() {
  return static_cast<double>(random_() >> 11) * 0x1p-53;  // the library's own distributions differ between libraries
}

// Gilbert, "Capacity of a Burst-Noise Channel", 1960, with certain loss in the bad state: it is left with 1 / burst,
// and entered as often as the wanted share asks for. With burst 1 the packets of a row are lost independently of each
// other.
bool DelayLine::drawn_loss() {
  if (spec_.loss <= 0) return false;
  if (spec_.loss >= 1) return true;
  const double u = uniform();
  if (spec_.burst <= 1) return u < spec_.loss;
  const double leave = 1 / spec_.burst, enter = std::min(1.0, leave * spec_.loss / (1 - spec_.loss));
  bad_ = bad_ ? u >= leave : u < enter;
  return bad_;
}

bool DelayLine::duplicated() {
  return spec_.duplicates > 0 && uniform() < spec_.duplicates;
}

DelayLine::Fate DelayLine::recorded(Duration at) const {
  const auto* trace = spec_.trace ? std::get_if<PacketTrace>(spec_.trace.get()) : nullptr;
  if (!trace) return {};
  const auto next = std::upper_bound(trace->at.begin(), trace->at.end(), at % trace->period);
  const auto index = static_cast<std::size_t>(next - trace->at.begin()) - 1;
  return {trace->delay[index], trace->lost[index]};
}

std::optional<RobotTime> DelayLine::send(RobotTime now, std::size_t bytes) {
  const Duration at = now - begin_;
  // Each packet draws the same numbers whatever becomes of it, so that one loss more leaves the others as they are.
  const bool lost = drawn_loss();
  const double jitter = spec_.jitter.count() > 0 ? uniform() : 0;
  const Fate fate = recorded(at);
  if (lost || fate.lost || end_of_outage(losing_, at) > at || !bottleneck_.has_room(at, bytes)) return std::nullopt;
  const Duration crossed = bottleneck_.carry(at, bytes);
  if (crossed >= kNever) return std::nullopt;
  Duration arrival = crossed + spec_.delay + fate.delay + seconds(jitter * to_seconds(spec_.jitter));
  const bool recorded_order = spec_.trace && std::holds_alternative<PacketTrace>(*spec_.trace);
  if (!spec_.reorder && !recorded_order) arrival = arrived_ = std::max(arrived_, arrival);
  return begin_ + arrival;
}

std::optional<RobotTime> DelayLine::idle_arrival(RobotTime sent, std::size_t bytes) const {
  const Duration at = sent - begin_;
  const Fate fate = recorded(at);
  if (fate.lost || end_of_outage(losing_, at) > at) return std::nullopt;
  return begin_ + bottleneck_.carry_alone(at, bytes) + spec_.delay + fate.delay;
}

}  // namespace foresight

#include "link/line/gaps.hpp"

#include <algorithm>

#include "link/line/bottleneck.hpp"

namespace foresight {
namespace {

void add_outages(std::vector<Gap>& gaps, const std::vector<Outage>& outages, Duration length) {
  for (const Outage& outage : outages)
    for (Duration begin = outage.at; begin < length; begin += outage.every) {
      gaps.push_back({begin, begin + outage.lasts});
      if (outage.every.count() <= 0) break;
    }
}

/// Between two chances that no outage takes.
void add_between_chances(std::vector<Gap>& gaps, const DeliveryTrace& trace, const std::vector<Outage>& outages,
                         Duration length) {
  Duration last{};
  const Duration period = std::chrono::milliseconds(trace.at_ms.back());
  for (Duration round{}; round < length; round += period)
    for (const std::uint32_t ms : trace.at_ms) {
      const Duration at = round + std::chrono::milliseconds(ms);
      if (end_of_outage(outages, at) > at) continue;
      gaps.push_back({last, at});
      last = at;
    }
  if (last < length) gaps.push_back({last, length});
}

void add_without_rate(std::vector<Gap>& gaps, const RateTrace& trace, Duration length) {
  for (Duration round{}; round < length; round += trace.period)
    for (std::size_t i = 0; i < trace.at.size(); ++i)
      if (trace.bytes_per_s[i] <= 0)
        gaps.push_back({round + trace.at[i], round + (i + 1 < trace.at.size() ? trace.at[i + 1] : trace.period)});
}

/// Sorted; those that touch are one.
std::vector<Gap> joined_up(std::vector<Gap> gaps) {
  std::ranges::sort(gaps, {}, &Gap::begin);
  std::vector<Gap> out;
  for (const Gap& gap : gaps)
    if (!out.empty() && gap.begin <= out.back().end)
      out.back().end = std::max(out.back().end, gap.end);
    else
      out.push_back(gap);
  return out;
}

}  // namespace

std::vector<Gap> gaps_of(const DirectionSpec& spec, Duration least, Duration length) {
  std::vector<Gap> gaps;
  const Trace* const trace = spec.trace.get();
  if (const auto* chances = trace ? std::get_if<DeliveryTrace>(trace) : nullptr) {
    add_between_chances(gaps, *chances, spec.outages, length);  // each ends with a chance: none of them are joined
  } else {
    if (const auto* rates = trace ? std::get_if<RateTrace>(trace) : nullptr) add_without_rate(gaps, *rates, length);
    add_outages(gaps, spec.outages, length);
    gaps = joined_up(std::move(gaps));
  }
  for (Gap& gap : gaps) gap.end = std::min(gap.end, length);
  std::erase_if(gaps, [&](const Gap& gap) { return gap.end - gap.begin < least; });
  return gaps;
}

}  // namespace foresight

#include "prediction/rate_limit.hpp"

#include <algorithm>
#include <cmath>

namespace foresight {
namespace {

constexpr double kEvery = 0.02;  // s between points on the way to a far command: nearer than those that are steps
constexpr double kLongest = 30;  // s
constexpr double kOver = 0.1;    // s that speeds are means of
constexpr double kOverMayDiffer = 0.05;  // s by which that may differ where states come seldom
constexpr double kAsksForMore = 1.15;
constexpr std::size_t kEnoughRates = 1000;

}  // namespace

void append_limited(PositionHistory& limited, const TimedPosition& now, double speed) noexcept {
  if (limited.empty() || !std::isfinite(speed)) {
    limited.add(now.time, now.position);
    return;
  }
  limited.forget_after(now.time);
  const TimedPosition last = limited.values().newest();
  // A command that comes soon after the one before was on its way all the time; a later one is a step.
  const bool soon = now.time - last.time <= PositionHistory::kSparse;
  const double may = soon ? speed * (now.time - last.time) : 0;
  double position = last.position + std::clamp(now.position - last.position, -may, may);
  limited.add(now.time, position);
  const double left = std::abs(now.position - position);
  const double way = speed * kEvery;
  for (int k = 1; left > (k - 1) * way && k * kEvery <= kLongest; ++k) {
    position += std::clamp(now.position - position, -way, way);
    limited.add(now.time + k * kEvery, position);
  }
}

std::optional<double> speed_reached(const PositionHistory& commands, const PositionHistory& states) noexcept {
  const auto& values = states.values();
  const std::size_t stride = values.size() / kEnoughRates + 1;
  double reached = 0, asked = 0;
  std::size_t count = 0;
  for (std::size_t i = 0; i < values.size(); i += stride) {
    const TimedPosition now = values[i];
    const auto then = states.measured_about(now.time - kOver, kOverMayDiffer);
    if (commands.empty() || !then || then->time < commands.values()[0].time) continue;
    const double over = now.time - then->time;
    reached = std::max(reached, std::abs(now.position - then->position) / over);
    asked = std::max(asked, std::abs(commands.at(now.time) - commands.at(then->time)) / over);
    ++count;
  }
  if (count < 40 || reached <= 0 || asked < kAsksForMore * reached) return {};
  return reached;
}

}  // namespace foresight

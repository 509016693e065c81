#include "apps/bench/even_times.hpp"

#include <algorithm>
#include <cmath>

#include "common/statistics.hpp"

namespace foresight {
namespace {

constexpr std::size_t kNear = 25;  // stamps to each side that tell when one was given
constexpr double kFollowed = 0.1;  // share of what a stamp is off by
constexpr double kMostScatter = 0.2, kLeastScatter = 0.01;

/// By how many intervals each is later than the first. One stamp alone is no place to count from.
std::vector<double> numbered(std::span<const double> stamps, double interval) {
  std::vector<double> out{0};
  double even = stamps[0];
  for (std::size_t i = 1; i < stamps.size(); ++i) {
    const double steps = std::max(1.0, std::round((stamps[i] - even) / interval));
    out.push_back(out.back() + steps);
    even += steps * interval;
    even += kFollowed * (stamps[i] - even);
  }
  return out;
}

/// The line through stamps `first` .. `end` by their numbers, at number `at`.
double on_line(std::span<const double> stamps, const std::vector<double>& number, std::size_t first, std::size_t end,
               double at) {
  double x = 0, y = 0, xx = 0, xy = 0;
  for (std::size_t i = first; i < end; ++i) x += number[i], y += stamps[i];
  const auto count = static_cast<double>(end - first);
  x /= count;
  y /= count;
  for (std::size_t i = first; i < end; ++i) {
    xx += (number[i] - x) * (number[i] - x);
    xy += (number[i] - x) * (stamps[i] - y);
  }
  return y + xy / xx * (at - x);
}

}  // namespace

std::optional<EvenTimes> even_times(std::span<const double> stamps) {
  if (stamps.size() < 2 * kNear) return std::nullopt;
  std::vector<double> intervals;
  for (std::size_t i = 1; i < stamps.size(); ++i) intervals.push_back(stamps[i] - stamps[i - 1]);
  EvenTimes out;
  out.interval = median(intervals);
  const std::vector<double> number = numbered(stamps, out.interval);
  double squares = 0;
  for (std::size_t i = 0; i < stamps.size(); ++i) {
    const std::size_t first = i > kNear ? i - kNear : 0, end = std::min(i + kNear + 1, stamps.size());
    out.times.push_back(on_line(stamps, number, first, end, number[i]));
    squares += (stamps[i] - out.times[i]) * (stamps[i] - out.times[i]);
    if (i > 0 && out.times[i] <= out.times[i - 1]) return std::nullopt;
  }
  out.scatter = std::sqrt(squares / static_cast<double>(stamps.size()));
  const bool some = out.scatter > kLeastScatter * out.interval && out.scatter < kMostScatter * out.interval;
  return some ? std::optional(out) : std::nullopt;
}

}  // namespace foresight

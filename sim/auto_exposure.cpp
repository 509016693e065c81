#include "sim/auto_exposure.hpp"

#include <algorithm>
#include <cmath>

namespace foresight::sim {
namespace {

// Slope of the response at mid grey: a stop of light is so many stops of the 8-bit value.
constexpr double kResponse = 1 / 2.2;

}  // namespace

std::vector<double> run_auto_exposure(const AutoExposure& control, int images, const Meter& meter) {
  const auto missing = [&](int image, double stops) {
    const double mean = std::max(meter(image, std::exp2(stops)), 1.0 / 255);
    return std::log2(control.target / mean) / kResponse;
  };
  const auto limited = [&](double stops) { return std::clamp(stops, -control.most_stops, control.most_stops); };

  double stops = 0;
  for (int i = 0; i < 8; ++i) stops = limited(stops + missing(0, stops));
  std::vector<double> in_force;  // stops of each image
  double next = stops;
  std::vector<double> posted;  // what was decided after each image
  for (int i = 0; i < images; ++i) {
    if (i > control.latency) stops = posted[static_cast<std::size_t>(i - 1 - control.latency)];
    in_force.push_back(stops);
    if (i % control.interval == 0) {
      const double off = missing(i, stops);
      // Steps that were posted and are not in force yet are not asked for again.
      const double ahead = next - stops;
      if (std::abs(off) > control.tolerance)
        next = limited(next + std::clamp(control.share * (off - ahead), -control.largest_step, control.largest_step));
    }
    posted.push_back(next);
  }
  for (double& s : in_force) s = std::exp2(s);
  return in_force;
}

}  // namespace foresight::sim

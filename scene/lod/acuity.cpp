#include "scene/lod/acuity.hpp"

#include <algorithm>
#include <cmath>

namespace foresight {
namespace {

constexpr double kLeast = 0.02;  // a fiftieth of the sharpness: nothing is left out altogether

double fading(double value, double from, double scale) {
  return value > from ? std::exp(-(value - from) / scale) : 1.0;
}

}  // namespace

double acuity(const SeenMotion& seen, const AcuityOptions& options) {
  double k = std::min(fading(seen.eccentricity, options.eccentricity_from, options.eccentricity_scale),
                      fading(seen.speed, options.speed_from, options.speed_scale));
  if (seen.gaze_distance) {
    const auto vergence = [&](double distance) { return 2 * std::atan2(options.eyes_apart / 2, distance); };
    const double apart = std::abs(vergence(*seen.gaze_distance) - vergence(seen.distance));
    k = std::min(k, fading(apart, options.vergence_from, options.vergence_scale));
  }
  return std::max(k, kLeast);
}

}  // namespace foresight

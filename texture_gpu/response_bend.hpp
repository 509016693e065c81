// How a camera's response bends on its way to white.
//
// Cameras do not cut light off at white, they bend towards it: bright values follow a change of
// exposure less than middle ones. The model is a power law below and a bend above,
//
//     x = v (1 + s v^6)
//
// v the 8-bit value / 255, x a measure of light that a change of exposure multiplies by the same
// factor everywhere. s = 0 is a power law that is cut off at 1; at s = 0.4 a value of 0.95 follows
// 0.4 times as far as one of 0.3. A polynomial, as the extraction goes through it for each texel.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <span>
#include <vector>

namespace foresight {

/// log x of a value v in 0 .. 1, v > 0, at bend s >= 0.
inline double log_light(double v, double s) {
  const double v3 = v * v * v;
  return std::log(v * (1 + s * v3 * v3));
}

/// v of light x >= 0; 1 from where white begins. To 1e-4 for s up to 1.
inline double value_of_light(double x, double s) {
  double v = std::min(x, 1.0);  // at or above the root of a convex function: Newton comes down to it
  for (int i = 0; i < 4; ++i) {
    const double t = s * v * v * v * v * v * v;
    v -= (v * (1 + t) - x) / (1 + 7 * t);
  }
  return std::min(v, 1.0);
}

/// Finds s: the one of a few at which pages of all brightnesses agree best on the gains of the images so
/// far. Starts at 0, and stays where no exposure changes. One thread.
class ResponseBend {
 public:
  static constexpr std::array<double, 5> kBends = {0, 0.12, 0.25, 0.4, 0.7};

  double value() const { return kBends[current_]; }

  /// Values of pages in a new image, and what they were in older ones.
  struct Pair {
    double now, then;   ///< 0 .. 1
    double log_gain;    ///< of the older image, of the present epoch
    double vignetting;  ///< log of the share of light that the page had more now, for its place in the image
  };
  /// `log_gain`: of the new image, at the present bend. Returns true where the bend has changed: an epoch ends.
  bool update(std::span<const Pair> pairs, double log_gain);

  /// A gain that was found in an older epoch, as the present one would have found it.
  std::uint32_t epoch() const { return static_cast<std::uint32_t>(changes_.size()); }
  double carried_over(double log_gain, std::uint32_t epoch) const;

 private:
  struct Change {
    double log_gain, scale;  ///< gains keep their distance from log_gain times scale
  };
  std::size_t current_ = 0;
  std::array<double, kBends.size()> misfit_{};
  std::vector<Change> changes_;
};

}  // namespace foresight

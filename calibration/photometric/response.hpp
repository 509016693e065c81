// How a camera turns light into grey levels, and how its lens darkens the corners.
//
//   grey level  v = f(t * L * V(r))      t exposure time, L radiance, V vignetting; saturates at 255
//   response    g = f^-1, relative exposure, g(255) = 1; kept as the slope n(v) = d ln g / d ln v at
//               kKnots, linear in ln v between them: a power law v^n is a constant slope, and g is
//               monotone as long as every slope is positive
//   vignetting  V(r) = 1 + a1 r^2 + a2 r^4 + a3 r^6, r = 1 half an image diagonal from the centre
//
// Sources: Debevec and Malik 1997 (response from an exposure series, in logarithms); Goldman 2010
// (even polynomial of the vignetting).
#pragma once

#include <array>
#include <cmath>
#include <vector>

namespace foresight {

inline constexpr int kKnots = 14;
inline constexpr std::array<double, kKnots> kKnotLevels{6, 9, 13, 19, 28, 40, 56, 75, 98, 125, 155, 190, 225, 255};

/// ln g(level), from the logarithms of the slopes. `level` above 0, in grey levels; T as Ceres wants it.
template <typename T>
T log_response(const T* log_slope, double level) {
  using std::exp;
  T sum(0);
  const double s = std::log(level);
  for (int k = kKnots - 2; k >= 0; --k) {
    const auto at = static_cast<std::size_t>(k);
    const double low = std::log(kKnotLevels[at]), high = std::log(kKnotLevels[at + 1]);
    const T slope_low = exp(log_slope[k]), slope_high = exp(log_slope[k + 1]);
    if (s >= high) continue;
    const double from = std::fmax(s, low), share = (from - low) / (high - low);
    const T slope_from = slope_low + share * (slope_high - slope_low);
    sum -= (high - from) * 0.5 * (slope_from + slope_high);
    if (s < low && k == 0) sum -= (low - s) * slope_low;
  }
  return sum;
}

struct Response {
  std::array<double, kKnots> log_slope{};  ///< 0: linear

  double inverse(double level) const;          ///< g: relative exposure of a grey level, 0 at 0
  double level(double exposure) const;         ///< f: grey level of a relative exposure, at most 255
  std::vector<double> table() const;           ///< g of the levels 0 to 255
  static Response power_law(double exponent);  ///< g = (level / 255)^exponent
};

struct Vignetting {
  std::array<double, 3> a{};

  double operator()(double r2) const { return 1 + r2 * (a[0] + r2 * (a[1] + r2 * a[2])); }
};

}  // namespace foresight

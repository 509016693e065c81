// How far off predictions are, learnt from how far off they were, so that the truth lies inside of 2 sigma as often as
// that should be.
//
// sigma = scale * level: `level` is the root of the mean square error of the last seconds; `scale` grows with each
// truth outside of 2 sigma and shrinks with each inside, in the ratio that balances at `kInside` of them. The shares
// then come out whatever the errors' distribution is, and however it changes (adaptive conformal inference: Gibbs and
// Candes 2021).
#pragma once

#include <algorithm>
#include <cmath>

namespace foresight {

/// One thread. No method allocates or throws.
class CalibratedSigma {
 public:
  static constexpr double kInside = 0.95;  ///< of the truths, within 2 sigma

  /// `start`: sigma before anything was seen, > 0. `least`: no sigma is below it. `memory`: seconds that count, > 0.
  /// `dimensions` of the error whose length is told: 1, or 3 for vectors.
  CalibratedSigma(double start, double least, double memory, int dimensions)
      : mean_square_(start * start), least_(least), memory_(memory) {
    // 2 sigma of one coordinate hold 95 %; the length of three normal ones passes 1.615 sqrt(3) sigma in 5 % of cases.
    scale_ = dimensions == 1 ? 1 : 0.807;
  }

  double sigma() const noexcept { return std::max(least_, scale_ * std::sqrt(mean_square_)); }

  /// A prediction made with `predicted` as its sigma was off by `error` >= 0; the truth before came `seconds` ago.
  void score(double error, double predicted, double seconds) noexcept {
    if (!std::isfinite(error) || !(predicted > 0)) return;
    const double kept = std::exp(-std::max(seconds, 0.0) / memory_);
    mean_square_ = kept * mean_square_ + (1 - kept) * error * error;
    // Neighbouring errors are alike: the rate goes with time, not with their number.
    const double rate = kRate * std::min(seconds, memory_);
    scale_ *= std::exp(rate * (error > 2 * predicted ? kInside : kInside - 1));
    scale_ = std::clamp(scale_, 0.2, 5.0);
  }

 private:
  static constexpr double kRate = 1;  ///< of log(scale) per second

  double mean_square_, least_, memory_, scale_;
};

}  // namespace foresight

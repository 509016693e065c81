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

  /// 2 sigma hold 95 % of one normal coordinate; 95 % of the lengths of three are within 1.615 of their rms.
  static constexpr double kScaleOfOne = 1, kScaleOfThree = 0.807;

  /// `rms` of the errors' lengths before anything was seen, > 0. `least`: no sigma is below it. `memory`: seconds that
  /// count, > 0. `scale`: what rms times that is sigma at first. `assumed`, 0 .. 1: how much of the rms was made wider
  /// than what was seen. As long as that counts, truths inside tell little of the scale.
  CalibratedSigma(double rms, double least, double memory, double scale, double assumed = 0)
      : mean_square_(rms * rms), least_(least), memory_(memory), scale_(scale), assumed_(assumed) {}

  /// What of an error is scored where a few far larger ones must not decide what is told for seconds: an event that no
  /// uncertainty covers, of which others tell.
  static double usual_part(double error, double predicted) noexcept { return std::min(error, 5 * predicted); }

  double sigma() const noexcept { return std::max(least_, scale_ * std::sqrt(mean_square_)); }

  /// A prediction made with `predicted` as its sigma was off by `error` >= 0; the truth before came `seconds` ago.
  void score(double error, double predicted, double seconds) noexcept {
    if (!std::isfinite(error) || !(predicted > 0)) return;
    const double kept = std::exp(-std::max(seconds, 0.0) / memory_);
    mean_square_ = kept * mean_square_ + (1 - kept) * error * error;
    assumed_ *= kept;
    // Neighbouring errors are alike: the rate goes with time, not with their number.
    const double rate = kRate * std::min(seconds, memory_);
    scale_ *= std::exp(rate * (error > 2 * predicted ? kInside : (1 - assumed_) * (kInside - 1)));
    scale_ = std::clamp(scale_, 0.2, 5.0);
  }

 private:
  static constexpr double kRate = 1;  ///< of log(scale) per second

  double mean_square_, least_, memory_, scale_, assumed_;
};

}  // namespace foresight

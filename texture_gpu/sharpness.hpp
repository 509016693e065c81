// How sharply images are shown: no more sharply than they are known to lie where they should.
#pragma once

#include <optional>
#include <span>

namespace foresight {

/// One page as agreement.comp saw it.
struct AgreementSample {
  float difference2 = -1;  ///< mean squared difference between image and texture, (0..1)^2; -1: not told
  float gradient2 = 0;     ///< mean squared gradient of the image there, (0..1)^2 / px^2
};

/// The share of the cubic filter with which views take colours from images and textures; the rest is linear. Images
/// that are seen larger or smaller than they were taken have a share on top of that (view.comp).
///
/// A picture whose place is uncertain by sigma px along each axis keeps exp(-sigma^2 w^2 / 2) of a frequency w (rad/px)
/// on average: the estimate of least squared error (Wiener's filter, where the signal is far above the noise) is as
/// much softer than the picture itself. Linear interpolation keeps sinc^2(w / 2 pi), on average over places between
/// pixels: to second order both lose the same, w^2 / 12, at sigma^2 = 1/6. So a share of 6 sigma^2 is linear.
///
/// sigma^2 is what the newest image differs from the textures that were there before it, per gradient: in
/// difference^2 = noise^2 + sigma^2 gradient^2 the slope through the medians of the flattest and of the most textured
/// pages (Wald 1940, The Fitting of Straight Lines if Both Variables are Subject to Error), mean over the last images.
/// One thread.
class SharpnessEstimator {
 public:
  /// Changes nothing where too few pages tell something, or all of them are alike.
  void update(std::span<const AgreementSample> samples);

  /// kLeast .. kMost.
  double cubic_share() const;
  /// sigma^2, px^2 along each axis; nothing as long as it is not known.
  std::optional<double> misplacement2() const { return misplacement2_; }

  /// Where everything lies exactly.
  static constexpr double kMost = 1;
  /// What textures hold has passed through a cubic filter before: a full one more rings at edges.
  static constexpr double kMostOfTextures = 0.6;
  /// Linear and softer would err less, and looks blurred.
  static constexpr double kLeast = 0.1;

 private:
  std::optional<double> misplacement2_;
  int images_ = 0;
};

}  // namespace foresight

// Evens out exposure: the gain of each image and the vignetting of each lens.
//
// Camera responses are close to a power law, so a factor in linear light is a factor in the
// 8-bit values too (g^(1/gamma)); all gains here are natural logarithms of that factor. An image
// is modelled as   log I(x) = log T(x) + g + v(r),   v(r) = a r^2 + b r^4,
// T the surface's brightness at the reference exposure (the first image's), r the distance from
// the image's centre in half diagonals.
#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "texture_gpu/chart_atlas.hpp"

namespace foresight {

/// One page as exposure.comp saw it.
struct ExposureSample {
  /// Mean, 0..1; -1: not seen; kWhite + mean where some of it is white: at least so bright.
  float brightness = -1;
  float radius2 = 0;                ///< squared distance from the image's centre
  float log_red = 0, log_blue = 0;  ///< of the means beside that of green (colour_balance.hpp)
  static constexpr float kWhite = 2;
  bool white() const { return brightness >= kWhite; }
};

/// For one camera. One thread.
class ExposureEstimator {
 public:
  /// Estimates the gain of a new image from its samples against the pages' references (`pages`,
  /// same order; nullptr allowed), the median of their log ratios, of pages of middle brightness where
  /// there are enough. White pages and nearly black ones
  /// do not count, but where hardly any others are left: a gain that is at least so large, or so
  /// small, is then better than the last. Keeps the last gain where fewer than 30 pages can be
  /// compared. Also refines the vignetting. Then renews references that are missing or older than
  /// 30 images, but those of middle brightness only by others of that kind.
  void update(std::span<const ExposureSample> samples, std::span<AtlasPage* const> pages, std::int64_t image);

  double log_gain() const { return log_gain_; }
  /// It was measured in the last image, or never was in any, so that all have the same; else it is that of an image
  /// before, or a bound.
  bool is_measured() const { return measured_; }
  /// (a, b); zero until it is known well enough to help: v(1) beyond three of its own sigma.
  Eigen::Vector2d vignetting() const { return applied_; }
  double vignetting_log(double r2) const { return r2 * (applied_.x() + r2 * applied_.y()); }

 private:
  void learn_vignetting(const std::vector<Eigen::Vector3d>& rows, double sigma);

  void renew(PageExposure& ref, const ExposureSample& sample, std::int64_t image) const;
  /// Of the surface at the reference exposure, vignetting taken out.
  double surface_log(const PageExposure& ref) const {
    return ref.log_surface - ref.radius2 * applied_.x() - ref.radius4 * applied_.y();
  }

  double log_gain_ = 0, steady_ = 0;
  bool rough_ = false;  // log_gain_ is a bound; steady_ is the last before
  bool ever_measured_ = false, measured_ = false;
  Eigen::Vector2d applied_ = Eigen::Vector2d::Zero();
  Eigen::Matrix2d information_ = Eigen::Matrix2d::Zero();
  Eigen::Vector2d moment_ = Eigen::Vector2d::Zero();
};

}  // namespace foresight

// Evens out the left camera's white balance, which cameras change as what they see changes.
//
// Of surfaces that were seen before, red and blue are compared beside green, as logarithms of 8-bit values: camera
// responses are close to a power law (exposure.hpp). An image is corrected to the first one's balance before it is
// used; views show the newest one's.
#pragma once

#include <opencv2/core.hpp>
#include <optional>
#include <span>

#include "texture_gpu/exposure.hpp"

namespace foresight {

/// By how much pages are redder and bluer, beside green, than PageExposure::hue: logarithms.
struct HueDifference {
  Eigen::Vector2d log = Eigen::Vector2d::Zero();    ///< red, blue: medians over the pages
  Eigen::Vector2d sigma = Eigen::Vector2d::Zero();  ///< of these
};

/// Nothing where fewer than 30 pages can be compared. `pages`: of the same order; nullptr allowed.
std::optional<HueDifference> hue_difference(std::span<const ExposureSample> samples, std::span<AtlasPage* const> pages);

/// An image, CV_8UC3, whose red and blue are exp(log) times too large, without that; what is white in all channels
/// stays white. The image itself where it is grey.
cv::Mat balanced(const cv::Mat& image, const Eigen::Vector2d& log);

/// Of one camera. One thread.
class WhiteBalance {
 public:
  /// Corrects an image by what is known so far; the image itself where that is nothing.
  cv::Mat apply(const cv::Mat& image);

  /// Of the image that was corrected last: how it differs from what was seen before; what it shows is remembered
  /// (PageExposure::hue). A difference counts from 0.4 % and twice its own error on. True: that image should be
  /// corrected anew.
  bool learn(std::span<const ExposureSample> samples, std::span<AtlasPage* const> pages);

  /// Factors on red, green and blue that show that image's balance: on textures, and on its pixels as they were
  /// corrected.
  Eigen::Vector3f factors() const { return factors_of(log_); }
  Eigen::Vector3f factors_on_image() const { return factors_of(applied_); }

 private:
  static Eigen::Vector3f factors_of(const Eigen::Vector2d& log) {
    return Eigen::Vector3d(std::exp(log.x()), 1, std::exp(log.y())).cast<float>();
  }

  Eigen::Vector2d log_ = Eigen::Vector2d::Zero();      // red, blue, beside green: the last image over the first
  Eigen::Vector2d applied_ = Eigen::Vector2d::Zero();  // of that, what its pixels are without
};

}  // namespace foresight

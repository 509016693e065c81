// Evens out how the right camera's colours differ from the left's: white balance and sensors, not exposure.
//
// Of surfaces that both have seen, red and blue are compared beside green, as logarithms of 8-bit values: camera
// responses are close to a power law (exposure.hpp). The right camera's images are then corrected before they are used.
#pragma once

#include <opencv2/core.hpp>
#include <optional>
#include <span>

#include "texture_gpu/exposure.hpp"

namespace foresight {

/// Of one right camera. One thread.
class ColourBalance {
 public:
  /// Corrects a right image, CV_8UC3, by what is known so far. The image itself where nothing is to be corrected, or it
  /// is grey.
  cv::Mat apply(const cv::Mat& right);

  /// Of the right camera's image that was corrected last: what is still left between it and what the left camera has
  /// seen (PageExposure::hue). Where fewer than 30 pages can be compared, nothing is learnt. True: that image should be
  /// corrected anew.
  bool learn(std::span<const ExposureSample> samples, std::span<AtlasPage* const> pages);

  /// Factors on its red and blue; nothing where the cameras are alike, within 3 %.
  std::optional<Eigen::Vector2d> factors() const;

 private:
  Eigen::Vector2d log_ = Eigen::Vector2d::Zero();      // red, blue, beside green: right over left
  Eigen::Vector2d applied_ = Eigen::Vector2d::Zero();  // that of the last image
  bool differs_ = false;                               // by so much that images are corrected
  int learnt_ = 0;                                     // images
};

}  // namespace foresight

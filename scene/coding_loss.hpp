// What coding an image for a line took away from it, tile by tile, as told by who had the image itself: who sees only
// what came cannot know.
#pragma once

#include <array>
#include <cstdint>
#include <opencv2/core.hpp>
#include <optional>
#include <span>
#include <vector>

#include "scene/contrast.hpp"

namespace foresight {

/// Tiles of an image, whatever its size.
inline constexpr int kLossColumns = 20, kLossRows = 15;
/// Steps of the share of a tile's pixels whose grey is off by more than kLossLevels: 0 below kLeastLoss, then one each
/// time that it doubles.
inline constexpr int kLossSteps = 7;
inline constexpr double kLossLevels = 10, kLeastLoss = 1.0 / 128;

/// The middle of a step. Range of `step`: 1 .. kLossSteps - 1.
double share_lost(int step);

/// Steps, CV_8UC1, kLossRows x kLossColumns, of images of one size and type: CV_8UC1 or CV_8UC3 (BGR).
cv::Mat coding_loss(const cv::Mat& taken, const cv::Mat& came);

/// Such steps row by row, as somebody else tells them; none: an empty one. Nothing where they are not as above.
std::optional<cv::Mat> loss_of(std::span<const std::uint8_t> steps);

/// Coding spares what is flat and takes away what is not: within the tiles of a step, pixels are told apart by the
/// contrast around them in what came, of which so many steps (contrast.hpp) make a class, the last one with the rest.
inline constexpr int kLossContrasts = 5, kStepsAContrast = 3;
constexpr int loss_contrast(int contrast_step) {
  return contrast_step < kStepsAContrast * kLossContrasts ? contrast_step / kStepsAContrast : kLossContrasts - 1;
}
/// Of tiles of higher steps too much is wrong, however flat they look.
inline constexpr int kToldSteps = 4;

/// Share of the pixels of each contrast that are off by more than kLossLevels, of each step: [step - 1][contrast].
using LossShares = std::array<std::array<double, kLossContrasts>, kToldSteps>;
/// Where nothing is told of contrasts: share_lost() for all of them.
LossShares even_loss_shares();

/// Of the images of late: who codes counts them.
class LossCount {
 public:
  /// `steps`: coding_loss() of the two, which are as there.
  void add(const cv::Mat& taken, const cv::Mat& came, const cv::Mat& steps);
  LossShares shares() const;

 private:
  struct Pixels {
    double all = 0, lost = 0;
  };
  std::array<std::array<Pixels, kLossContrasts>, kToldSteps> of_late_{};
};

/// In a byte each, by step and then by contrast. As somebody else tells them: none are even_loss_shares(), nothing
/// where it is another number of bytes.
std::vector<std::uint8_t> to_bytes(const LossShares& shares);
std::optional<LossShares> loss_shares_of(std::span<const std::uint8_t> bytes);

/// Pixels of an image of `size` in tiles that have lost next to nothing: CV_8UC1, 255 or 0. `loss`: as above, or empty
/// where nothing is known to be lost.
cv::Mat kept_mask(const cv::Mat& loss, cv::Size size);

/// Differences of grey (ITU-R BT.601), CV_8UC1. Pictures: CV_8UC1, CV_8UC3 or CV_8UC4, of one size.
cv::Mat grey_difference(const cv::Mat& one, const cv::Mat& other);

}  // namespace foresight

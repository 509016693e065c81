// How much a shown picture is like the camera's image, on the pixels that were really seen.
//
// Pictures are 8 bit, BGR or BGRA in OpenCV's channel order; all of one comparison have one size.
// Masks are CV_8UC1, non-zero where a pixel counts. Every function is pure; objects are immutable
// and safe to share.
#pragma once

#include <opencv2/core.hpp>
#include <optional>

namespace foresight {

/// What the alpha of a predicted picture says (view_alpha.hpp), as shares of all image pixels. The four add up to 1.
struct Coverage {
  double seen = 0;        ///< colour from a camera image
  double filled = 0;      ///< filled hole
  double uncoloured = 0;  ///< model without any colour
  double no_model = 0;

  /// Neither seen nor filled.
  double empty() const { return uncoloured + no_model; }
  /// Share of the model's own pixels that have a colour; nothing where no model is in view.
  std::optional<double> coloured_of_model() const;
};

/// Throws std::invalid_argument unless `predicted` is CV_8UC4 and not empty.
Coverage measure_coverage(const cv::Mat& predicted);

/// CV_8UC1, 255 where `predicted` (CV_8UC4) carries colour from a camera image.
cv::Mat seen_mask(const cv::Mat& predicted);

/// Each is empty where nothing could be measured.
struct ImageQuality {
  std::optional<double> psnr_db;    ///< higher is better; at most kMaxPsnr
  std::optional<double> ssim;       ///< in [-1, 1]; 1 for equal pictures
  std::optional<double> sharpness;  ///< 1: as sharp as the actual image; less: blurred; more: noisy
};

/// Compares pictures with one actual image over one mask.
class ImageComparison {
 public:
  static constexpr double kMaxPsnr = 100;  ///< dB; equal pictures would be infinitely alike

  /// `actual`: CV_8UC3 or CV_8UC4 (alpha is ignored); `seen`: CV_8UC1. Keeps references to the
  /// pixels. Throws std::invalid_argument for other types, sizes that differ, or no pixels.
  ImageComparison(const cv::Mat& actual, const cv::Mat& seen);

  /// All three measures; `shown` as `actual`, of the same size, else std::invalid_argument.
  ImageQuality measure(const cv::Mat& shown) const;

  /// 10 log10(255^2 / MSE) over all three channels of the seen pixels. Empty: no pixel is seen.
  std::optional<double> psnr_db(const cv::Mat& shown) const;

  /// Structural similarity of the luma (Wang et al. 2004, eq. 13; 11x11 Gaussian of sigma 1.5,
  /// K1 = 0.01, K2 = 0.03). Unseen pixels and those beyond the border have no weight: the window's
  /// moments are normalised by the weight that is left. The mean is over the seen pixels that keep
  /// at least half of their window's weight. Empty: there is no such pixel.
  std::optional<double> ssim(const cv::Mat& shown) const;

  /// Mean Sobel gradient magnitude of the luma relative to the actual image's, over the seen pixels
  /// whose 5x5 neighbours are seen too: the border of the seen area is no edge of the picture.
  /// Empty: there is no such pixel, or the actual image is flat there.
  std::optional<double> sharpness(const cv::Mat& shown) const;

 private:
  cv::Mat luma_of(const cv::Mat& shown) const;

  cv::Mat actual_;       // CV_8UC3
  cv::Mat actual_luma_;  // CV_8UC1
  cv::Mat seen_;         // CV_8UC1, 0 or 1
  cv::Mat inner_;        // seen_, eroded
  int seen_count_ = 0;
  double actual_gradient_ = 0;
};

}  // namespace foresight

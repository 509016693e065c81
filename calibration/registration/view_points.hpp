// The pixels of a rendered view that tell something about the camera's pose.
#pragma once

#include <vector>

#include "calibration/registration/photometric_refinement.hpp"

namespace foresight {

/// One pixel of one level.
struct ViewPoint {
  Eigen::Vector3d p_view;                    ///< surface point, the view's camera frame, metres
  double value;                              ///< grey of the view
  Eigen::Matrix<double, 1, 6> slope;         ///< d value / d twist of the camera: what the image shows when it moves
  Eigen::Matrix<double, 2, 6> displacement;  ///< d pixel / d twist, px of level 0
  int block;                                 ///< index of its block of 16x16 pixels of level 0
};

/// A pyramid's level, CV_32FC1: level 0 lightly smoothed, each next one half as large.
std::vector<cv::Mat> grey_pyramid(const cv::Mat& picture, int levels);

/// CV_8UC1, 255 where the view's colour is evidence.
cv::Mat evidence_mask(const RenderedView& view, const RefinementOptions& options);

/// Pixels of `level` (grey `values`) with enough slope and evidence, at most one in 2x2.
std::vector<ViewPoint> find_view_points(const Lens& lens, const RenderedView& view, const cv::Mat& values,
                                        const cv::Mat& mask, int level, const RefinementOptions& options);

/// Does this block judge instead of taking part?
inline bool judges(int block) {
  return block % 4 == 1;
}

/// Bilinear, pixel centres at integers; nothing outside.
std::optional<double> sample(const cv::Mat& values, const Eigen::Vector2d& pixel);

/// Pixel of level 0 in the coordinates of `level`.
inline Eigen::Vector2d to_level(const Eigen::Vector2d& pixel, int level) {
  const double scale = 1.0 / (1 << level);
  return ((pixel.array() + 0.5) * scale - 0.5).matrix();
}

}  // namespace foresight

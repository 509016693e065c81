// The corners of a whole chessboard, each from its rough place.
#pragma once

#include <vector>

#include "calibration/target/grid_order.hpp"

namespace foresight {

struct RefinedCorner {
  cv::Point2f at;
  double noise_px = 0;  ///< standard deviation of a coordinate
};

/// OpenCV guesses corners along the rim whose squares it did not find, several side by side, and out
/// of the refinement's reach. Those that lie away from where their neighbours in line have them, by a
/// tenth of the spacing, are refined from there too, and the better one is taken; of the neighbours
/// only those count that agree with theirs.
std::vector<RefinedCorner> refine_grid(const cv::Mat& grey, GridPoints points, int cols, int rows);

}  // namespace foresight

// How good a view of a board is (find_corners.hpp says what the figures mean).
#pragma once

#include "calibration/target/find_corners.hpp"

namespace foresight {

/// `p_board`: of every point of the board. At least four corners that do not lie in a line.
ViewQuality view_quality(const cv::Mat& grey, const std::vector<Corner>& corners,
                         const std::vector<Eigen::Vector3d>& p_board);

}  // namespace foresight

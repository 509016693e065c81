// The chessboard that a panel shows, and its corners in pictures taken through the lens.
#pragma once

#include <filesystem>
#include <opencv2/core.hpp>
#include <string>
#include <vector>

#include "calibration/display_lens/display_lens.hpp"

namespace foresight {

struct PanelPattern {
  int width = 0;   ///< px of the panel
  int height = 0;  ///< px
  int cols = 0;    ///< inner corners
  int rows = 0;
  int square = 0;  ///< px

  /// Throws InputError where the squares do not fit; cols and rows of unlike parity tell up from down.
  void validate() const;

  /// Panel pixel of a corner, between four pixels: half integers.
  Eigen::Vector2d corner(int col, int row) const;
};

/// "1440x1600:9x8:120": panel, inner corners, square in px. Throws InputError naming the part.
PanelPattern parse_pattern(const std::string& text);

/// What the panel shows: black squares on white, CV_8U.
cv::Mat draw_pattern(const PanelPattern& pattern);

/// The pattern's corners in `image` (8-bit, one channel), refined; empty where the whole board is not seen. Ordered
/// so that the board stands upright within 90 degrees.
std::vector<PanelPoint> find_pattern(const PanelPattern& pattern, const cv::Mat& image, int picture);

/// Rows "picture u v panel_u panel_v": camera and panel pixels; pictures counted from 0. Throws InputError naming
/// file and line.
std::vector<PanelPoint> read_panel_points(const std::filesystem::path& file);

}  // namespace foresight

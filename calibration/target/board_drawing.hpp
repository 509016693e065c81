// A board as ink: what print_board.hpp puts on paper and what the mock lab shows.
#pragma once

#include <cairo.h>

#include <opencv2/core.hpp>

#include "calibration/target/board.hpp"

namespace foresight {

/// Board frame, metres: the ink, with the white that it needs.
struct BoardExtent {
  double left = 0, top = 0, right = 0, bottom = 0;
  double width() const { return right - left; }
  double height() const { return bottom - top; }
};

BoardExtent board_extent(const Board& board);

/// In mm, black, the board's origin at (0, 0). A ChArUco board needs marker size and dictionary.
void draw_board(cairo_t* cairo, const Board& board);

/// Throws InputError naming a complete board where one leaves open what a print must know.
void require_printable(const Board& board);

/// A board on a sheet of paper with a rim of 0.3 sizes around its extent.
struct BoardPicture {
  cv::Mat picture;  ///< CV_8UC1, from the paper's upper left corner: 0 ink, 255 paper, linear in between
  double width_m = 0, height_m = 0;
  Eigen::Vector2d origin_m;  ///< the board's origin, right of and below the paper's upper left corner
};

/// About `longest_px` pixels along the longer side; squares and tags begin and end with a pixel. Throws what
/// require_printable() throws.
BoardPicture board_picture(const Board& board, int longest_px = 2500);

}  // namespace foresight

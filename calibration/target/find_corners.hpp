// Finds a calibration board in an image, to a fraction of a pixel.
//
// Order: rows run to the right and columns down for a viewer in front of the board. A chessboard
// whose columns + rows are odd starts at the corner next to a dark square; a grid of circles with
// one bigger dot starts at that dot where its rows allow it. Other grids look the same after half a
// turn (square ones after a quarter): they start where the rows run most to the right in the image.
//
// A grid of tags may count its rows from the lower edge (kalibr) or the upper one: what is found
// comes in board.hpp's order either way.
#pragma once

#include <memory>
#include <opencv2/core.hpp>
#include <optional>
#include <string>
#include <vector>

#include "calibration/target/board.hpp"
#include "calibration/target/corner_set.hpp"

namespace foresight {

/// What makes a view worth taking; comparable between views of one board and camera.
struct ViewQuality {
  double sharpness =
      0;  ///< 1/px: steepest edges over contrast, along the board's blurrier axis; 1 is as sharp as pixels get
  double tilt_deg = 0;  ///< between the board's normal and the line of sight, for a lens of normal width
  double turn_deg = 0;  ///< where the far side lies in the image: 0 right, 90 down; of no meaning without tilt
  double coverage = 0;  ///< share of the image between the outermost points
};

struct FoundBoard {
  std::vector<Corner> corners;  ///< ascending by index, as BoardView wants them
  ViewQuality quality;
  bool partial = false;    ///< some points are missing; only boards with IDs can be
  bool ambiguous = false;  ///< the order may be another after half a turn: see above
};

/// A board's finder. One thread at a time; several finders may work at once.
class BoardFinder {
 public:
  /// Throws InputError where the board names a family or dictionary that does not exist, naming the
  /// nearest, or has more tags than it. A ChArUco board must name its dictionary: complete_board().
  explicit BoardFinder(const Board& board);
  ~BoardFinder();
  BoardFinder(BoardFinder&&) noexcept;

  /// `grey`: 8 bit, one channel. Nothing where the board is not in it (whole, unless it has IDs).
  std::optional<FoundBoard> find(const cv::Mat& grey);

  const Board& board() const;

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

/// `board` with what was left to find: dictionary and marker size of a ChArUco board, from the
/// images that show most. Unchanged where nothing is missing or no image shows a marker.
Board complete_board(const Board& board, const std::vector<cv::Mat>& greys);

/// Why no image shows `board`, and what fits: "0 tags of tag36h11; tag25h9 fits: give apriltag:...".
/// Two sentences at most; says so where nothing else fits either. Slow: seconds an image.
std::string explain_nothing_found(const Board& board, const std::vector<cv::Mat>& greys);

/// Turns the right view's order where it is ambiguous, so that rows run alike in both images of a
/// pair. Both have all points.
void align_order(const Board& board, const FoundBoard& left, FoundBoard& right);

}  // namespace foresight

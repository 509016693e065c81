// Points of a board as they were found in images.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

namespace foresight {

/// One point of the board in one image.
struct Corner {
  int index = 0;          ///< into CornerSet::p_board
  Eigen::Vector2d pixel;  ///< px, pixel centres at integers, finite
  double sigma_px = 1;    ///< standard deviation of each coordinate as the finder estimates it, relative is enough; > 0
};

/// What one image shows of the board; a point at most once, in ascending order of index.
struct BoardView {
  std::string name;             ///< of the image, for messages; the same for both images of a stereo pair
  std::vector<Corner> corners;  ///< at least four, not all in a line
};

/// All views of one camera.
struct CornerSet {
  int width = 0;                         ///< px; 0: unknown, the corners came from a file
  int height = 0;                        ///< px
  std::vector<Eigen::Vector3d> p_board;  ///< every point of the board, board frame, metres
  std::vector<BoardView> views;
};

/// Two cameras that saw the board at the same instants: views of equal name belong together; a
/// view that one camera lacks is allowed and helps its own intrinsics only.
struct StereoCorners {
  CornerSet left;
  CornerSet right;
};

}  // namespace foresight

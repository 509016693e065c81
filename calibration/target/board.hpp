// Calibration boards: what is printed, and where its points lie.
//
//   board frame: origin at the first point, x along a row of points, y along a column, z into the
//   board (away from a viewer who sees rows run to the right and columns down); metres
//
//   o--x      chessboard   the inner corners, cols x rows of them
//   |         charuco      the inner corners of cols x rows squares, so (cols-1) x (rows-1) of them
//   y         apriltag     four corners of each of cols x rows tags, see corner_index()
//             circles      the centres of a symmetric grid, cols x rows of them
#pragma once

#include <Eigen/Core>
#include <string>
#include <string_view>
#include <vector>

namespace foresight {

enum class BoardKind { chessboard, charuco, apriltag, circles };

struct Board {
  BoardKind kind = BoardKind::chessboard;
  int cols = 0;  ///< of points, squares or tags: see above
  int rows = 0;
  double size_m = 0;    ///< side of a square, of a tag's black border, or distance of circle centres
  double marker_m = 0;  ///< charuco: side of a marker; 0: found from the images
  double gap_m = 0;     ///< apriltag: between the black borders of neighbouring tags
  std::string family;   ///< "tag36h11"; charuco: "DICT_6X6_250"; empty: found from the images
};

/// `KIND:COLSxROWS:SIZE_M[:EXTRA[:FAMILY]]`, such as "chessboard:9x6:0.025",
/// "charuco:5x7:0.036195:0.018256:DICT_6X6_250" (EXTRA is the side of a marker) or
/// "apriltag:6x6:0.055:0.0165:tag36h11" (EXTRA is the gap; 0.3 of the side and tag36h11 by
/// default, as kalibr prints). Throws InputError naming the part that is wrong and an example.
Board parse_board(std::string_view text);

/// The form that parse_board reads.
std::string to_string(const Board& board);

/// Position of every point in the board frame, z = 0, in the order of their indices: row by row
/// from the origin. Tags count row by row from the origin, four corners each:
/// index = 4 * tag + corner, corners counter-clockwise as seen in print from the lower left
/// (AprilTag's order: lower left, lower right, upper right, upper left).
std::vector<Eigen::Vector3d> board_points(const Board& board);

}  // namespace foresight

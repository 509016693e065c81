// Corners that another program found.
//
//   NAME.vnl     mrcal: "filename x y [level|weight]", one row a point, the points of an image one
//                after the other in the board's order; "-" where a point was not seen; one row of "-"
//                for an image without the board. sigma_px is 2^level, or 1/weight.
//   FOLDER       one camera: <ns>.csv a view; a pair: such folders cam0/ and cam1/. Columns
//                ts,tag_rows,tag_cols,tag_size,tag_spacing,kp_x,kp_y,p_x,p_y,p_z,tag_id,corner_idx,
//                in any order where a header names them. p is in the board frame, metres; a point's
//                index is its rank by tag_id, then corner_idx.
#pragma once

#include <filesystem>
#include <optional>

#include "calibration/target/board.hpp"
#include "calibration/target/corner_set.hpp"

namespace foresight {

/// One camera's views; sizes stay 0. A .vnl file needs `board`; a folder brings its own points.
/// Views that show fewer than four points, or all of them in a line, are left out; at least one
/// view remains. Throws InputError naming file and line: unknown column, wrong number of fields or
/// points, a number that is not finite (and the point's index), a point twice, another place for
/// the same point, two cameras where one is wanted.
CornerSet read_corners(const std::filesystem::path& path, const std::optional<Board>& board);

/// Both cameras' views; both sets have the same p_board. Files of a pair are told apart by
/// split_side(), views of a folder by their stamps. Throws like read_corners, and where a name
/// says neither camera, one camera is missing, or no view has both.
StereoCorners read_stereo_corners(const std::filesystem::path& path, const std::optional<Board>& board);

/// Whether the points are enough, and do not lie in a line.
bool spans_a_plane(const std::vector<Corner>& corners);

}  // namespace foresight

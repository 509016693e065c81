// Regular grids of points and the orders in which they can be read.
#pragma once

#include <opencv2/core.hpp>
#include <vector>

namespace foresight {

using GridPoints = std::vector<cv::Point2f>;  ///< row by row

/// All ways to read a cols x rows grid whose rows run to the right and columns down for a viewer in
/// front of it: two, four where cols == rows. The one whose rows run most to the right comes first.
/// `points` may be mirrored.
std::vector<GridPoints> grid_orders(const GridPoints& points, int cols, int rows);

/// Mean direction of the rows, px from one column to the next.
cv::Point2f row_direction(const GridPoints& points, int cols, int rows);

/// Distance of each point to its nearest neighbour along row and column, px.
std::vector<float> neighbour_spacing(const GridPoints& points, int cols, int rows);

}  // namespace foresight

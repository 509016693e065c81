#include "calibration/target/grid_order.hpp"

#include <algorithm>
#include <limits>

namespace foresight {
namespace {

std::size_t at(int col, int row, int cols) {
  return static_cast<std::size_t>(row * cols + col);
}

GridPoints quarter_turn(const GridPoints& points, int n) {
  GridPoints turned(points.size());
  for (int row = 0; row < n; ++row)
    for (int col = 0; col < n; ++col) turned[at(col, row, n)] = points[at(n - 1 - row, col, n)];
  return turned;
}

float to_the_right(const GridPoints& points, int cols, int rows) {
  const cv::Point2f x = row_direction(points, cols, rows);
  return x.x / std::hypot(x.x, x.y);
}

}  // namespace

cv::Point2f row_direction(const GridPoints& points, int cols, int rows) {
  cv::Point2f sum;
  for (int row = 0; row < rows; ++row) sum += points[at(cols - 1, row, cols)] - points[at(0, row, cols)];
  return sum / static_cast<float>(rows * (cols - 1));
}

std::vector<GridPoints> grid_orders(const GridPoints& points, int cols, int rows) {
  GridPoints upright = points;
  const cv::Point2f x = row_direction(points, cols, rows);
  cv::Point2f y;
  for (int col = 0; col < cols; ++col) y += points[at(col, rows - 1, cols)] - points[at(col, 0, cols)];
  if (x.cross(y) < 0)
    for (int row = 0; row < rows; ++row) std::reverse(upright.begin() + row * cols, upright.begin() + (row + 1) * cols);
  std::vector<GridPoints> orders{upright, GridPoints(upright.rbegin(), upright.rend())};
  if (cols == rows) {
    orders.push_back(quarter_turn(orders[0], cols));
    orders.push_back(quarter_turn(orders[1], cols));
  }
  std::stable_sort(orders.begin(), orders.end(), [&](const GridPoints& a, const GridPoints& b) {
    return to_the_right(a, cols, rows) > to_the_right(b, cols, rows);
  });
  return orders;
}

std::vector<float> neighbour_spacing(const GridPoints& points, int cols, int rows) {
  std::vector<float> spacing(points.size(), std::numeric_limits<float>::max());
  const auto link = [&](std::size_t a, std::size_t b) {
    const cv::Point2f d = points[a] - points[b];
    const float distance = std::hypot(d.x, d.y);
    spacing[a] = std::min(spacing[a], distance);
    spacing[b] = std::min(spacing[b], distance);
  };
  for (int row = 0; row < rows; ++row)
    for (int col = 0; col < cols; ++col) {
      if (col + 1 < cols) link(at(col, row, cols), at(col + 1, row, cols));
      if (row + 1 < rows) link(at(col, row, cols), at(col, row + 1, cols));
    }
  return spacing;
}

}  // namespace foresight

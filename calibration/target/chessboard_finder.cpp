#include <algorithm>
#include <opencv2/calib3d.hpp>
#include <opencv2/imgproc.hpp>

#include "calibration/target/board_finders.hpp"
#include "calibration/target/grid_order.hpp"
#include "calibration/target/refine_grid.hpp"

namespace foresight {
namespace {

constexpr int kReducedSide = 1000;  // px: finding takes a tenth of a second, refining sees all pixels

cv::Mat reduced(const cv::Mat& grey, int side = kReducedSide) {
  const double scale = static_cast<double>(side) / std::max(grey.cols, grey.rows);
  if (scale >= 1) return grey;
  cv::Mat small;
  cv::resize(grey, small, {}, scale, scale, cv::INTER_AREA);
  return small;
}

// The finder by quads takes milliseconds where all are seen, but where one of many is missing it tries them in
// combinations: minutes for an image of a large board. In noise it goes through thousands of them, 10 s for 640 x 480:
// so it looks only where a fast check sees squares, and goes on without that check in a picture that is small.
constexpr int kMostByQuads = 150;
constexpr int kUncheckedSide = 320;  // px

// The finder by sectors sees through blur and glare, at ten times the cost of a good image's quads. Equalising lifts
// boards out of the dark, and fills others with noise.
bool find_by_sectors(const cv::Mat& grey, cv::Size size, GridPoints& points) {
  return cv::findChessboardCornersSB(grey, size, points, 0) ||
         cv::findChessboardCornersSB(grey, size, points, cv::CALIB_CB_NORMALIZE_IMAGE);
}

// Equalised grey values find boards in poor light, but lose those before something brighter and move corners.
constexpr int kPlain = cv::CALIB_CB_ADAPTIVE_THRESH, kEqualised = kPlain | cv::CALIB_CB_NORMALIZE_IMAGE;

bool find_by_quads(const cv::Mat& grey, cv::Size size, GridPoints& points, int flags) {
  return cv::findChessboardCorners(grey, size, points, kPlain | flags) ||
         cv::findChessboardCorners(grey, size, points, kEqualised | flags);
}

/// From pixels of `small` to those of `grey`, of which it is a reduced picture.
GridPoints enlarged(const GridPoints& points, const cv::Mat& small, const cv::Mat& grey) {
  const float x = static_cast<float>(grey.cols) / static_cast<float>(small.cols);
  const float y = static_cast<float>(grey.rows) / static_cast<float>(small.rows);
  GridPoints out;
  for (const cv::Point2f& p : points) out.emplace_back((p.x + 0.5f) * x - 0.5f, (p.y + 0.5f) * y - 0.5f);
  return out;
}

GridPoints rough_corners(const cv::Mat& grey, cv::Size size) {
  const bool by_quads = size.area() <= kMostByQuads;
  const cv::Mat small = reduced(grey);
  GridPoints points;
  if ((by_quads && find_by_quads(small, size, points, cv::CALIB_CB_FAST_CHECK)) || find_by_sectors(small, size, points))
    return enlarged(points, small, grey);
  if (by_quads) {
    const cv::Mat smallest = reduced(grey, kUncheckedSide);
    if (find_by_quads(smallest, size, points, 0)) return enlarged(points, smallest, grey);
  }
  if (small.size() == grey.size()) return {};
  const bool found = by_quads ? cv::findChessboardCorners(grey, size, points, kEqualised | cv::CALIB_CB_FAST_CHECK)
                              : cv::findChessboardCornersSB(grey, size, points, 0);
  return found ? points : GridPoints{};
}

double brightness(const cv::Mat& grey, cv::Point2f at) {
  cv::Mat patch;
  cv::getRectSubPix(grey, {3, 3}, at, patch, CV_32F);
  return cv::mean(patch)[0];
}

/// Whether the square between the first two rows and columns is darker than its neighbour.
bool starts_dark(const cv::Mat& grey, const GridPoints& p, int cols) {
  const auto n = static_cast<std::size_t>(cols);
  double sum = 0;
  for (std::size_t i = 0; i + 1 < n; ++i) {
    const double value = brightness(grey, (p[i] + p[i + 1] + p[n + i] + p[n + i + 1]) / 4);
    sum += i % 2 == 0 ? -value / static_cast<double>(n / 2) : value / static_cast<double>((n - 1) / 2);
  }
  return sum > 0;
}

}  // namespace

FoundPoints find_chessboard(const cv::Mat& grey, const Board& board) {
  const GridPoints rough = rough_corners(grey, {board.cols, board.rows});
  if (rough.empty()) return {};
  const auto orders = grid_orders(rough, board.cols, board.rows);
  GridPoints chosen;
  std::size_t dark = 0;
  if (board.cols > 2)
    for (const GridPoints& order : orders)
      if (starts_dark(grey, order, board.cols) && dark++ == 0) chosen = order;
  FoundPoints found;
  found.ambiguous = dark != 1;
  if (chosen.empty()) chosen = orders.front();
  const auto corners = refine_grid(grey, chosen, board.cols, board.rows);
  for (std::size_t i = 0; i < corners.size(); ++i)
    found.corners.push_back({static_cast<int>(i), {corners[i].at.x, corners[i].at.y}, corners[i].noise_px});
  return found;
}

bool shows_chessboard(const cv::Mat& grey, cv::Size corners) {
  GridPoints points;
  return cv::findChessboardCornersSB(reduced(grey), corners, points, 0);
}

std::optional<cv::Size> any_chessboard(const cv::Mat& grey) {
  const cv::Mat small = reduced(grey);
  for (const int flags : {0, static_cast<int>(cv::CALIB_CB_NORMALIZE_IMAGE)}) {
    GridPoints points;
    cv::Mat meta;
    if (cv::findChessboardCornersSB(small, {3, 3}, points, flags | cv::CALIB_CB_LARGER, meta) && !meta.empty())
      return meta.size();
  }
  return std::nullopt;
}

}  // namespace foresight

#include "calibration/target/board_drawing.hpp"

#include <algorithm>
#include <cmath>
#include <memory>
#include <opencv2/aruco/charuco.hpp>

#include "calibration/tags/tag_family.hpp"
#include "calibration/target/board_finders.hpp"
#include "common/error.hpp"

namespace foresight {
namespace {

constexpr double kRim = 0.3;  // of the board's size_m

/// Dark pixels of `bits` as squares of one path, so that no hairline of white runs between neighbours.
void fill_bits(cairo_t* cairo, const cv::Mat& bits, double x, double y, double side) {
  const double bit = side / bits.cols;
  for (int row = 0; row < bits.rows; ++row)
    for (int col = 0; col < bits.cols;) {
      const int begin = col;
      while (col < bits.cols && bits.at<uchar>(row, col) < 128) ++col;
      if (col > begin) {
        // Overlaps the row below by a hair; the sides stay exact.
        const bool last = row + 1 == bits.rows;
        cairo_rectangle(cairo, x + begin * bit, y + row * bit, (col - begin) * bit, bit * (last ? 1 : 1.02));
      } else {
        ++col;
      }
    }
  cairo_fill(cairo);
}

}  // namespace

BoardExtent board_extent(const Board& board) {
  const double s = board.size_m;
  switch (board.kind) {
    case BoardKind::chessboard: return {-1.2 * s, -1.2 * s, (board.cols + 0.2) * s, (board.rows + 0.2) * s};
    case BoardKind::charuco: return {-1.2 * s, -1.2 * s, (board.cols - 0.8) * s, (board.rows - 0.8) * s};
    case BoardKind::circles: return {-s / 2, -s / 2, (board.cols - 0.5) * s, (board.rows - 0.5) * s};
    default: {
      const double rim = s / 4, pitch = s + board.gap_m;
      return {-rim, -rim, board.cols * pitch - board.gap_m + rim, board.rows * pitch - board.gap_m + rim};
    }
  }
}

void draw_board(cairo_t* cairo, const Board& board) {
  const double s = board.size_m * 1e3;
  const auto dark_squares = [&](int cols, int rows) {
    for (int row = 0; row < rows; ++row)
      for (int col = 0; col < cols; ++col)
        if ((row + col) % 2 == 0) cairo_rectangle(cairo, (col - 1) * s, (row - 1) * s, s, s);
    cairo_fill(cairo);
  };
  switch (board.kind) {
    case BoardKind::chessboard: dark_squares(board.cols + 1, board.rows + 1); break;
    case BoardKind::circles:
      for (const Eigen::Vector3d& p : board_points(board)) {
        cairo_new_sub_path(cairo);
        cairo_arc(cairo, p.x() * 1e3, p.y() * 1e3, s / 4, 0, 2 * M_PI);
      }
      cairo_fill(cairo);
      break;
    case BoardKind::apriltag: {
      const double pitch = (board.size_m + board.gap_m) * 1e3;
      for (int tag = 0; tag < board.cols * board.rows; ++tag)
        fill_bits(cairo, tag_image(board.family, tag), tag % board.cols * pitch, tag / board.cols * pitch, s);
      break;
    }
    case BoardKind::charuco: {
      dark_squares(board.cols, board.rows);
      const auto dictionary = cv::aruco::getPredefinedDictionary(charuco_dictionary(board.family));
      const double marker = board.marker_m * 1e3;
      int id = 0;
      for (int row = 0; row < board.rows; ++row)
        for (int col = 0; col < board.cols; ++col) {
          if ((row + col) % 2 == 0) continue;
          cv::Mat bits;
          dictionary->drawMarker(id++, dictionary->markerSize + 2, bits, 1);
          fill_bits(cairo, bits, (col - 0.5) * s - marker / 2, (row - 0.5) * s - marker / 2, marker);
        }
      break;
    }
  }
}

void require_printable(const Board& board) {
  if (board.kind != BoardKind::charuco || (board.marker_m > 0 && !board.family.empty())) return;
  Board example = board;
  if (example.marker_m <= 0) example.marker_m = 0.7 * board.size_m;
  if (example.family.empty()) example.family = "DICT_5X5_1000";
  throw InputError("--board", "a ChArUco board is printed with markers of a size and a dictionary",
                   "give " + to_string(example));
}

BoardPicture board_picture(const Board& board, int longest_px) {
  require_printable(board);
  const BoardExtent e = board_extent(board);
  const double rim = kRim * board.size_m;
  const double size_px =
      std::max(8.0, std::round(longest_px * board.size_m / (std::max(e.width(), e.height()) + 2 * rim)));
  const double pixel_m = board.size_m / size_px;
  const auto pixels = [&](double metres) { return static_cast<int>(std::ceil(metres / pixel_m - 1e-6)); };
  BoardPicture out;
  const int left = pixels(rim - e.left), top = pixels(rim - e.top);
  out.picture = cv::Mat(top + pixels(e.bottom + rim), left + pixels(e.right + rim), CV_8UC1);
  out.width_m = out.picture.cols * pixel_m;
  out.height_m = out.picture.rows * pixel_m;
  out.origin_m = {left * pixel_m, top * pixel_m};
  const std::unique_ptr<cairo_surface_t, void (*)(cairo_surface_t*)> surface(
      cairo_image_surface_create(CAIRO_FORMAT_A8, out.picture.cols, out.picture.rows), cairo_surface_destroy);
  const std::unique_ptr<cairo_t, void (*)(cairo_t*)> cairo(cairo_create(surface.get()), cairo_destroy);
  cairo_set_antialias(cairo.get(), CAIRO_ANTIALIAS_BEST);
  cairo_translate(cairo.get(), left, top);
  cairo_scale(cairo.get(), 1e-3 / pixel_m, 1e-3 / pixel_m);
  draw_board(cairo.get(), board);
  cairo_surface_flush(surface.get());
  const cv::Mat ink(out.picture.size(), CV_8UC1, cairo_image_surface_get_data(surface.get()),
                    static_cast<std::size_t>(cairo_image_surface_get_stride(surface.get())));
  out.picture = 255 - ink;
  return out;
}

}  // namespace foresight

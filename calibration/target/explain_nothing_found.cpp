#include <algorithm>
#include <opencv2/core.hpp>

#include "calibration/tags/tag_family.hpp"
#include "calibration/target/board_finders.hpp"
#include "calibration/target/find_corners.hpp"
#include "calibration/target/grid_order.hpp"

namespace foresight {
namespace {

constexpr std::size_t kMostImages = 3;  // a wrong board is wrong in each

std::string size_text(int cols, int rows) {
  return std::to_string(cols) + "x" + std::to_string(rows);
}

std::string mirrored_text(const Board& board, const std::vector<cv::Mat>& greys) {
  BoardFinder finder(board);
  for (const cv::Mat& grey : greys) {
    cv::Mat mirrored;
    cv::flip(grey, mirrored, 1);
    if (finder.find(mirrored)) return "it is found in the mirrored image: turn mirroring off in the camera";
  }
  return {};
}

// Squares are often counted where corners are asked for.
bool counts_squares(const Board& board, const std::vector<cv::Mat>& greys) {
  const cv::Size corners(board.cols - 1, board.rows - 1);
  return corners.height > 1 && corners.width > 1 &&
         std::any_of(greys.begin(), greys.end(), [&](const cv::Mat& grey) { return shows_chessboard(grey, corners); });
}

// Of a board that is partly covered a smaller one may be seen: the largest of all images counts.
std::string other_chessboard(const Board& board, const std::vector<cv::Mat>& greys) {
  const std::string asked = size_text(board.cols, board.rows);
  Board other = board;
  if (counts_squares(board, greys)) {
    --other.cols, --other.rows;
    return asked + " not found; " + asked + " counts its squares, --board counts the " +
           size_text(other.cols, other.rows) + " corners between them: give " + to_string(other);
  }
  cv::Size seen;
  for (const cv::Mat& grey : greys)
    if (const auto size = any_chessboard(grey); size && size->area() > seen.area()) seen = *size;
  const bool as_asked = seen == cv::Size(board.cols, board.rows) || seen == cv::Size(board.rows, board.cols);
  if (seen.empty() || as_asked)
    return asked + " not found, nor another chessboard; see that the whole board with a white rim is in the image";
  // In the direction that was asked for: the longer side stays the longer one.
  if ((seen.width > seen.height) != (board.cols > board.rows)) std::swap(seen.width, seen.height);
  other.cols = seen.width;
  other.rows = seen.height;
  return asked + " not found; " + size_text(other.cols, other.rows) + " inner corners were: give " + to_string(other) +
         " if that is the whole board";
}

std::string other_circles(const Board& board, const std::vector<cv::Mat>& greys) {
  const std::string missing = size_text(board.cols, board.rows) + " circles not found";
  for (const auto& [cols, rows] : {std::pair{-1, 0}, {0, -1}, {-1, -1}, {1, 0}, {0, 1}, {1, 1}}) {
    Board other = board;
    other.cols += cols;
    other.rows += rows;
    if (other.cols < 2 || other.rows < 2) continue;
    BoardFinder finder(other);
    for (const cv::Mat& grey : greys)
      if (finder.find(grey))
        return missing + "; " + size_text(other.cols, other.rows) + " were: give " + to_string(other);
  }
  return missing + "; see that the whole board is in the image";
}

std::string other_family(const Board& board, const std::vector<cv::Mat>& greys) {
  const std::string missing = "0 tags of " + board.family;
  if (const std::string mirrored = mirrored_text(board, greys); !mirrored.empty()) return missing + "; " + mirrored;
  std::size_t most = 1;
  Board best = board;
  for (const std::string& family : tag_families()) {
    Board other = board;
    other.family = family;
    if (family == board.family) continue;
    if (family == "tag16h5" && other.cols * other.rows > 30) other.cols = 30, other.rows = 1;
    if (family == "tag25h9" && other.cols * other.rows > 35) other.cols = 35, other.rows = 1;
    if (family == "tagCircle21h7" && other.cols * other.rows > 38) other.cols = 38, other.rows = 1;
    TagFinder finder(other);
    std::size_t tags = 0;
    for (const cv::Mat& grey : greys) {
      finder.find(grey);
      tags += finder.last_tags();
    }
    if (tags > most) best.family = family, most = tags;
  }
  if (best.family == board.family) return missing + ", nor of another family";
  return missing + "; " + best.family + " fits: give " + to_string(best);
}

std::string other_dictionary(const Board& board, const std::vector<cv::Mat>& greys) {
  Board other = board;
  if (board.family.empty()) return "no marker of any dictionary was found";
  const std::string missing = "0 corners between markers of " + board.family;
  if (const std::string mirrored = mirrored_text(board, greys); !mirrored.empty()) return missing + "; " + mirrored;
  other.family = fitting_dictionary(board, greys);
  if (other.family.empty() || other.family == board.family) return missing + ", nor of another dictionary";
  other = complete_board(other, greys);
  return missing + "; " + other.family + " fits: give " + to_string(other);
}

}  // namespace

std::string explain_nothing_found(const Board& board, const std::vector<cv::Mat>& greys) {
  std::vector<cv::Mat> some;
  const std::size_t step = std::max<std::size_t>(1, greys.size() / kMostImages);
  for (std::size_t i = 0; i < greys.size() && some.size() < kMostImages; i += step) some.push_back(greys[i]);
  switch (board.kind) {
    case BoardKind::chessboard: return other_chessboard(board, some);
    case BoardKind::circles: return other_circles(board, some);
    case BoardKind::apriltag: return other_family(board, some);
    default: return other_dictionary(board, some);
  }
}

}  // namespace foresight

// One finder a kind of board; find_corners.hpp joins them.
#pragma once

#include <opencv2/core.hpp>
#include <optional>
#include <string>
#include <vector>

#include "calibration/tags/tag_detector.hpp"
#include "calibration/target/board.hpp"
#include "calibration/target/corner_set.hpp"

namespace foresight {

/// Empty where the board is not seen.
struct FoundPoints {
  std::vector<Corner> corners;
  bool ambiguous = false;
};

FoundPoints find_chessboard(const cv::Mat& grey, const Board& board);
FoundPoints find_circles(const cv::Mat& grey, const Board& board);

/// Whether the image shows a chessboard of so many inner corners, whole.
bool shows_chessboard(const cv::Mat& grey, cv::Size corners);

/// Inner corners of a chessboard in the image, at least of a part of it, whatever their number; nothing where there is
/// none.
std::optional<cv::Size> any_chessboard(const cv::Mat& grey);

FoundPoints find_charuco(const cv::Mat& grey, const Board& board);

/// Number of OpenCV's dictionary "DICT_6X6_250"; throws InputError naming the nearest.
int charuco_dictionary(const std::string& name);

/// The dictionary that most of the board's markers belong to; empty where no image shows two.
std::string fitting_dictionary(const Board& board, const std::vector<cv::Mat>& greys);

/// Side of the markers over that of the squares; nothing where no image shows two markers.
std::optional<double> marker_share(const Board& board, const std::vector<cv::Mat>& greys);

/// The tags of one board.
class TagFinder {
 public:
  explicit TagFinder(const Board& board);

  FoundPoints find(const cv::Mat& grey);
  std::size_t last_tags() const;  ///< of the board, that the last image showed

 private:
  Board board_;
  TagDetector detector_;
  std::size_t last_tags_ = 0;
};

}  // namespace foresight

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <opencv2/calib3d.hpp>

#include "calibration/tags/tag_family.hpp"
#include "calibration/target/board_finders.hpp"
#include "calibration/target/refine_corners.hpp"
#include "common/counted.hpp"
#include "common/error.hpp"

namespace foresight {
namespace {

constexpr double kWindowShare = 0.1;  // half window of a corner over the tag's side: only for its noise

std::string cure_for_few_tags(const Board& board) {
  int most = 0;
  for (const std::string& family : tag_families()) {
    const int tags = tags_in_family(family);
    if (tags >= board.cols * board.rows) return "name a larger family, such as " + family;
    most = std::max(most, tags);
  }
  return "no family has so many: take fewer columns or rows, at most " + counted(most, "tag");
}

TagDetector::Options detector_options(const Board& board) {
  const int tags = tags_in_family(board.family);
  if (tags < board.cols * board.rows)
    throw InputError(
        "--board",
        board.family + " has " + counted(tags, "tag") + ", the board " + std::to_string(board.cols * board.rows),
        cure_for_few_tags(board));
  return {board.family, 0, 0, 0};
}

Eigen::Vector2d centre_of(const DetectedTag& tag) {
  return tag.H.col(2).hnormalized();
}

/// Rows counted from the lower edge of the print, as kalibr does: every pair of tags votes.
bool counts_upwards(const std::vector<DetectedTag>& tags, int cols) {
  int votes = 0;
  for (const DetectedTag& a : tags) {
    const Eigen::Matrix3d inverse = a.H.inverse();
    for (const DetectedTag& b : tags) {
      const int rows_down = b.id / cols - a.id / cols;
      if (rows_down == 0) continue;
      const Eigen::Vector2d at = (inverse * centre_of(b).homogeneous()).hnormalized();
      votes += (at.y() > 0) == (rows_down > 0) ? 1 : -1;
    }
  }
  return votes < 0;
}

double shortest_side(const DetectedTag& tag) {
  double shortest = 1e9;
  for (std::size_t i = 0; i < 4; ++i) shortest = std::min(shortest, (tag.corners[i] - tag.corners[(i + 1) % 4]).norm());
  return shortest;
}

/// Drops tags that lie where no tag of the board can: misread ones, and those of another board.
void drop_strays(std::vector<DetectedTag>& tags, const Board& board) {
  if (tags.size() < 5) return;
  std::vector<cv::Point2f> grid, image;
  double side = 0;
  for (const DetectedTag& tag : tags) {
    grid.emplace_back(static_cast<float>(tag.id % board.cols), static_cast<float>(tag.id / board.cols));
    image.emplace_back(static_cast<float>(centre_of(tag).x()), static_cast<float>(centre_of(tag).y()));
    side += shortest_side(tag) / static_cast<double>(tags.size());
  }
  cv::Mat keep;
  const cv::Mat H = cv::findHomography(grid, image, cv::RANSAC, 0.5 * side, keep);
  if (H.empty()) return;
  std::vector<DetectedTag> kept;
  for (std::size_t i = 0; i < tags.size(); ++i)
    if (keep.at<uchar>(static_cast<int>(i)) != 0) kept.push_back(tags[i]);
  tags = std::move(kept);
}

}  // namespace

TagFinder::TagFinder(const Board& board) : board_(board), detector_(detector_options(board)) {}

std::size_t TagFinder::last_tags() const {
  return last_tags_;
}

FoundPoints TagFinder::find(const cv::Mat& grey) {
  std::vector<DetectedTag> tags = detector_.detect(grey);
  std::erase_if(tags, [&](const DetectedTag& tag) { return tag.id >= board_.cols * board_.rows; });
  drop_strays(tags, board_);
  last_tags_ = tags.size();
  if (counts_upwards(tags, board_.cols))
    for (DetectedTag& tag : tags)
      tag.id = (board_.rows - 1 - tag.id / board_.cols) * board_.cols + tag.id % board_.cols;
  std::sort(tags.begin(), tags.end(), [](const DetectedTag& a, const DetectedTag& b) { return a.id < b.id; });
  FoundPoints found;
  for (const DetectedTag& tag : tags) {
    const int window = refinement_half_window(static_cast<float>(shortest_side(tag)), kWindowShare);
    for (std::size_t c = 0; c < 4; ++c) {
      const Eigen::Vector2d& p = tag.corners[c];
      const cv::Point2f at(static_cast<float>(p.x()), static_cast<float>(p.y()));
      found.corners.push_back({4 * tag.id + static_cast<int>(c), p, corner_noise(grey, at, window)});
    }
  }
  return found;
}

}  // namespace foresight

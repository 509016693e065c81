#include "calibration/target/find_corners.hpp"

#include <algorithm>

#include "calibration/target/board_finders.hpp"
#include "calibration/target/corner_files.hpp"
#include "calibration/target/grid_order.hpp"
#include "calibration/target/view_quality.hpp"
#include "common/error.hpp"

namespace foresight {
namespace {

Eigen::Vector2d direction_of_rows(const Board& board, const std::vector<Corner>& corners) {
  const auto n = static_cast<std::size_t>(board.cols);
  Eigen::Vector2d sum = Eigen::Vector2d::Zero();
  for (std::size_t first = 0; first + n <= corners.size(); first += n)
    sum += (corners[first + n - 1].pixel - corners[first].pixel);
  return sum.normalized();
}

std::vector<Corner> reordered(const std::vector<Corner>& corners, const std::vector<int>& order) {
  std::vector<Corner> turned;
  for (std::size_t i = 0; i < order.size(); ++i) {
    turned.push_back(corners[static_cast<std::size_t>(order[i])]);
    turned.back().index = static_cast<int>(i);
  }
  return turned;
}

}  // namespace

class BoardFinder::Impl {
 public:
  explicit Impl(const Board& board) : board_(board), p_board_(board_points(board)) {
    if (board.kind == BoardKind::apriltag) tags_ = std::make_unique<TagFinder>(board);
    if (board.kind == BoardKind::charuco) charuco_dictionary(board.family);
  }

  std::optional<FoundBoard> find(const cv::Mat& grey) {
    CV_Assert(grey.type() == CV_8UC1);
    FoundPoints points;
    switch (board_.kind) {
      case BoardKind::chessboard: points = find_chessboard(grey, board_); break;
      case BoardKind::circles: points = find_circles(grey, board_); break;
      case BoardKind::charuco: points = find_charuco(grey, board_); break;
      case BoardKind::apriltag: points = tags_->find(grey); break;
    }
    if (!spans_a_plane(points.corners)) return std::nullopt;
    FoundBoard found;
    found.partial = points.corners.size() < p_board_.size();
    found.ambiguous = points.ambiguous;
    found.quality = view_quality(grey, points.corners, p_board_);
    found.corners = std::move(points.corners);
    return found;
  }

  const Board& board() const { return board_; }

 private:
  Board board_;
  std::vector<Eigen::Vector3d> p_board_;
  std::unique_ptr<TagFinder> tags_;
};

BoardFinder::BoardFinder(const Board& board) : impl_(std::make_unique<Impl>(board)) {}
BoardFinder::~BoardFinder() = default;
BoardFinder::BoardFinder(BoardFinder&&) noexcept = default;

std::optional<FoundBoard> BoardFinder::find(const cv::Mat& grey) {
  return impl_->find(grey);
}

const Board& BoardFinder::board() const {
  return impl_->board();
}

Board complete_board(const Board& board, const std::vector<cv::Mat>& greys) {
  Board complete = board;
  if (board.kind != BoardKind::charuco) return complete;
  if (complete.family.empty()) complete.family = fitting_dictionary(board, greys);
  if (complete.marker_m <= 0 && !complete.family.empty())
    if (const auto share = marker_share(complete, greys)) complete.marker_m = *share * board.size_m;
  return complete;
}

void align_order(const Board& board, const FoundBoard& left, FoundBoard& right) {
  if (!left.ambiguous || !right.ambiguous) return;
  GridPoints indices;  // the indices themselves, read in every order
  for (int row = 0; row < board.rows; ++row)
    for (int col = 0; col < board.cols; ++col) indices.emplace_back(static_cast<float>(col), static_cast<float>(row));
  const Eigen::Vector2d wanted = direction_of_rows(board, left.corners);
  std::vector<Corner> best = right.corners;
  for (const GridPoints& order : grid_orders(indices, board.cols, board.rows)) {
    std::vector<int> from;
    for (const cv::Point2f& p : order) from.push_back(static_cast<int>(p.y) * board.cols + static_cast<int>(p.x));
    const auto turned = reordered(right.corners, from);
    if (direction_of_rows(board, turned).dot(wanted) > direction_of_rows(board, best).dot(wanted) + 1e-9) best = turned;
  }
  right.corners = std::move(best);
}

}  // namespace foresight

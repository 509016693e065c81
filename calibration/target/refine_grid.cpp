#include "calibration/target/refine_grid.hpp"

#include <algorithm>
#include <array>

#include "calibration/target/refine_corners.hpp"
#include "common/statistics.hpp"

namespace foresight {
namespace {

constexpr double kDoubtful = 0.1;  // of the neighbour spacing, between a rough corner and what its neighbours say

/// Where the neighbours in line with point (col, row) say that it lies: the median over up to four directions.
/// Neighbours in `doubtful` have no say, unless there are no others.
cv::Point2f foretold(const GridPoints& p, int cols, int rows, int col, int row, const std::vector<char>& doubtful) {
  std::array<std::vector<float>, 2> guesses;
  for (const auto& [dx, dy] : {std::pair{1, 0}, {-1, 0}, {0, 1}, {0, -1}}) {
    const int far_col = col + 2 * dx, far_row = row + 2 * dy;
    if (far_col < 0 || far_col >= cols || far_row < 0 || far_row >= rows) continue;
    const auto near = static_cast<std::size_t>((row + dy) * cols + col + dx);
    const auto far = static_cast<std::size_t>(far_row * cols + far_col);
    if (doubtful[near] || doubtful[far]) continue;
    const cv::Point2f guess = 2 * p[near] - p[far];
    guesses[0].push_back(guess.x);
    guesses[1].push_back(guess.y);
  }
  if (guesses[0].empty()) {
    const bool others = std::any_of(doubtful.begin(), doubtful.end(), [](char d) { return d != 0; });
    return others ? foretold(p, cols, rows, col, row, std::vector<char>(p.size(), 0))
                  : p[static_cast<std::size_t>(row * cols + col)];
  }
  return {median(std::move(guesses[0])), median(std::move(guesses[1]))};
}

/// Along the rim, OpenCV may have guessed a corner from squares that it did not find: out of the refinement's reach.
/// `sure`: the neighbours are where they belong.
RefinedCorner refined(const cv::Mat& grey, cv::Point2f rough, cv::Point2f guess, float spacing, bool sure) {
  const int window = refinement_half_window(spacing);
  const auto from = [&](cv::Point2f start) {
    const cv::Point2f p = refine_corner(grey, start, window);
    return RefinedCorner{p, corner_noise(grey, p, window)};
  };
  const RefinedCorner usual = from(rough);
  if (cv::norm(rough - guess) < kDoubtful * spacing) return usual;
  const RefinedCorner other = from(guess);
  const bool better = sure ? cv::norm(other.at - guess) < cv::norm(usual.at - guess) : other.noise_px < usual.noise_px;
  return better ? other : usual;
}

// Those that lie away from where their neighbours in line have them.
std::vector<char> doubtful_points(const GridPoints& p, const std::vector<float>& spacing, int cols, int rows) {
  const std::vector<char> none(p.size(), 0);
  std::vector<char> doubtful = none;
  for (std::size_t i = 0; i < p.size(); ++i) {
    const int k = static_cast<int>(i);
    doubtful[i] = cv::norm(p[i] - foretold(p, cols, rows, k % cols, k / cols, none)) >= kDoubtful * spacing[i];
  }
  return doubtful;
}

}  // namespace

std::vector<RefinedCorner> refine_grid(const cv::Mat& grey, GridPoints points, int cols, int rows) {
  const auto spacing = neighbour_spacing(points, cols, rows);
  std::vector<RefinedCorner> corners(points.size());
  for (const bool sure : {false, true}) {
    const auto doubtful = doubtful_points(points, spacing, cols, rows);
    for (std::size_t i = 0; i < points.size(); ++i) {
      if (sure && !doubtful[i]) continue;
      const int k = static_cast<int>(i);
      const cv::Point2f guess = foretold(points, cols, rows, k % cols, k / cols, doubtful);
      corners[i] = refined(grey, points[i], guess, spacing[i], sure);
      points[i] = corners[i].at;
    }
  }
  return corners;
}

}  // namespace foresight

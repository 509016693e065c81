#include "calibration/target/refine_grid.hpp"

#include <algorithm>
#include <array>

#include "calibration/target/refine_corners.hpp"
#include "common/statistics.hpp"

namespace foresight {
namespace {

constexpr double kDoubtful = 0.1;  // of the neighbour spacing, between a rough corner and what its neighbours say

constexpr double kMostNoiseRatio = 2;  // a place of more noise than that, beside another one, shows no corner
constexpr float kMostGrowth = 2;       // of squares in a line, from one to the next

/// Goes on by one square, from `far` over `near`. With `farther`, as squares grow in a perspective view: with lengths a
/// and then b, and r = b / a, the next one is b (r + 1) / (3 - r).
cv::Point2f gone_on(cv::Point2f near, cv::Point2f far, const cv::Point2f* farther) {
  const cv::Point2f step = near - far;
  if (!farther) return near + step;
  const auto before = static_cast<float>(cv::norm(far - *farther));
  const float growth =
      std::clamp(static_cast<float>(cv::norm(step)) / std::max(before, 1e-3f), 1 / kMostGrowth, kMostGrowth);
  return near + step * ((growth + 1) / (3 - growth));
}

/// Where the neighbours in line with point (col, row) say that it lies: the median over up to four directions.
/// Neighbours in `doubtful` have no say, unless there are no others.
cv::Point2f foretold(const GridPoints& p, int cols, int rows, int col, int row, const std::vector<char>& doubtful) {
  std::array<std::vector<float>, 2> guesses;
  for (const cv::Point step : {cv::Point(1, 0), cv::Point(-1, 0), cv::Point(0, 1), cv::Point(0, -1)}) {
    const auto in_line = [&](int steps) -> const cv::Point2f* {
      const int x = col + steps * step.x, y = row + steps * step.y;
      if (x < 0 || x >= cols || y < 0 || y >= rows) return nullptr;
      const auto at = static_cast<std::size_t>(y * cols + x);
      return doubtful[at] ? nullptr : &p[at];
    };
    const cv::Point2f *near = in_line(1), *far = in_line(2);
    if (!near || !far) continue;
    const cv::Point2f guess = gone_on(*near, *far, in_line(3));
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
  const bool better = sure ? cv::norm(other.at - guess) < cv::norm(usual.at - guess) &&
                                 other.noise_px < kMostNoiseRatio * usual.noise_px
                           : other.noise_px < usual.noise_px;
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

#include "calibration/display_lens/panel_pattern.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <opencv2/calib3d.hpp>
#include <opencv2/imgproc.hpp>

#include "common/error.hpp"
#include "common/text.hpp"
#include "scene/text_table.hpp"

namespace foresight {
namespace {

constexpr const char* kExample = "1440x1600:9x8:120";
constexpr int kLargestPanel = 16384;  // px
constexpr double kWindow = 0.25;      // of the distance of neighbours: half the side of the refinement's window

[[noreturn]] void refuse(const std::string& text, const std::string& what) {
  throw InputError("--pattern", "the pattern " + in_quotes(text) + " " + what,
                   std::string("give PANEL:CORNERS:SQUARE in pixels, such as ") + kExample);
}

std::pair<int, int> pair_of(const std::string& text, const std::string& part, int least, int most) {
  const auto at = part.find('x');
  const auto a = parse_integer(part.substr(0, at));
  const auto b = at == std::string::npos ? std::nullopt : parse_integer(part.substr(at + 1));
  if (!a || !b || *a < least || *b < least || *a > most || *b > most) refuse(text, "has " + in_quotes(part));
  return {static_cast<int>(*a), static_cast<int>(*b)};
}

double shortest_neighbour(const std::vector<cv::Point2f>& corners, int cols) {
  double least = INFINITY;
  for (std::size_t i = 1; i < corners.size(); ++i)
    if (i % static_cast<std::size_t>(cols)) least = std::min(least, cv::norm(corners[i] - corners[i - 1]));
  return least;
}

}  // namespace

void PanelPattern::validate() const {
  if ((cols + 1) * square > width || (rows + 1) * square > height)
    throw InputError("--pattern",
                     std::to_string(cols + 1) + " x " + std::to_string(rows + 1) + " squares of " +
                         std::to_string(square) + " px do not fit into the panel",
                     "use squares of at most " + std::to_string(std::min(width / (cols + 1), height / (rows + 1))) +
                         " px, or fewer corners");
  if ((cols + rows) % 2 == 0)
    throw InputError(
        "--pattern",
        "a board of " + std::to_string(cols) + " x " + std::to_string(rows) + " corners looks the same upside down",
        "use an odd number on one side and an even one on the other");
}

Eigen::Vector2d PanelPattern::corner(int col, int row) const {
  const int left = (width - (cols + 1) * square) / 2, top = (height - (rows + 1) * square) / 2;
  return {left + (col + 1) * square - 0.5, top + (row + 1) * square - 0.5};
}

PanelPattern parse_pattern(const std::string& text) {
  const auto first = text.find(':'), second = text.find(':', first == std::string::npos ? first : first + 1);
  if (second == std::string::npos) refuse(text, "has no three parts between colons");
  PanelPattern p;
  std::tie(p.width, p.height) = pair_of(text, text.substr(0, first), 16, kLargestPanel);
  std::tie(p.cols, p.rows) = pair_of(text, text.substr(first + 1, second - first - 1), 3, 200);
  const auto square = parse_integer(text.substr(second + 1));
  if (!square || *square < 4 || *square > kLargestPanel) refuse(text, "has no square in pixels");
  p.square = static_cast<int>(*square);
  p.validate();
  return p;
}

cv::Mat draw_pattern(const PanelPattern& pattern) {
  cv::Mat image(pattern.height, pattern.width, CV_8U, cv::Scalar(255));
  for (int row = -1; row < pattern.rows; ++row)
    for (int col = -1; col < pattern.cols; ++col) {
      if ((row + col) % 2) continue;
      const Eigen::Vector2d at = pattern.corner(col, row);
      image(cv::Rect(static_cast<int>(at.x() + 0.5), static_cast<int>(at.y() + 0.5), pattern.square, pattern.square)) =
          0;
    }
  return image;
}

std::vector<PanelPoint> find_pattern(const PanelPattern& pattern, const cv::Mat& image, int picture) {
  std::vector<cv::Point2f> corners;
  const cv::Size board(pattern.cols, pattern.rows);
  if (!cv::findChessboardCornersSB(image, board, corners, cv::CALIB_CB_NORMALIZE_IMAGE | cv::CALIB_CB_EXHAUSTIVE))
    return {};
  // Half a turn is told by where row 0 lies: above the last row, or left of it where the board lies on its side.
  const cv::Point2f down = corners[corners.size() - static_cast<std::size_t>(pattern.cols)] - corners[0];
  if (std::abs(down.y) >= std::abs(down.x) ? down.y < 0 : down.x > 0) std::reverse(corners.begin(), corners.end());
  const int half = std::clamp(static_cast<int>(kWindow * shortest_neighbour(corners, pattern.cols)), 2, 11);
  cv::cornerSubPix(image, corners, {half, half}, {-1, -1}, {cv::TermCriteria::COUNT + cv::TermCriteria::EPS, 40, 1e-3});
  std::vector<PanelPoint> points;
  for (int row = 0; row < pattern.rows; ++row)
    for (int col = 0; col < pattern.cols; ++col) {
      const cv::Point2f& at = corners[static_cast<std::size_t>(row * pattern.cols + col)];
      points.push_back({picture, {at.x, at.y}, pattern.corner(col, row)});
    }
  return points;
}

std::vector<PanelPoint> read_panel_points(const std::filesystem::path& file) {
  std::vector<PanelPoint> points;
  for_each_row(file, "picture u v panel_u panel_v", [&](const TextRow& row) {
    const auto picture = parse_integer(row.fields[0]);
    std::array<double, 4> v{};
    for (std::size_t i = 0; i < 4; ++i) {
      const auto value = parse_number(row.fields[i + 1]);
      if (!value || !(std::abs(*value) < 1e6))
        throw InputError(row.where(), in_quotes(row.fields[i + 1]) + " is no pixel", "write a decimal number");
      v[i] = *value;
    }
    if (!picture || *picture < 0 || *picture > 10000)
      throw InputError(row.where(), "does not start with the picture's number", "count the pictures from 0");
    points.push_back({static_cast<int>(*picture), {v[0], v[1]}, {v[2], v[3]}});
  });
  return points;
}

}  // namespace foresight

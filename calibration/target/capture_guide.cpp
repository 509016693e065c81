#include "calibration/target/capture_guide.hpp"

#include <algorithm>
#include <array>
#include <limits>
#include <map>
#include <opencv2/imgproc.hpp>

#include "common/text.hpp"

namespace foresight {
namespace {

int cell(double at, int length, int cells) {
  return std::clamp(static_cast<int>(at * cells / length), 0, cells - 1);
}

std::string place(int column, int row, int columns, int rows) {
  const std::string across = column == 0 ? "left" : column + 1 == columns ? "right" : "";
  const std::string down = row == 0 ? "upper" : row + 1 == rows ? "lower" : "";
  if (!across.empty() && !down.empty()) return "the " + down + " " + across + " corner";
  if (!across.empty()) return "the middle of the " + across + " side";
  if (!down.empty()) return "the middle of the " + down + " side";
  return "the middle";
}

/// 0 right, 1 down, 2 left, 3 up: where the far side of a tilted board lies.
int quarter(double turn_deg) {
  const int q = static_cast<int>(std::lround(turn_deg / 90));
  return ((q % 4) + 4) % 4;
}

/// Tilt as a vector towards the far side, degrees.
Eigen::Vector2d lean(const ViewQuality& quality) {
  const double turn = quality.turn_deg * CV_PI / 180;
  return quality.tilt_deg * Eigen::Vector2d(std::cos(turn), std::sin(turn));
}

/// The hull of the corners.
std::vector<Eigen::Vector2d> outline(const std::vector<Corner>& corners) {
  std::vector<cv::Point2f> points, hull;
  for (const Corner& corner : corners)
    points.emplace_back(static_cast<float>(corner.pixel.x()), static_cast<float>(corner.pixel.y()));
  if (points.empty()) return {};
  cv::convexHull(points, hull);
  std::vector<Eigen::Vector2d> out;
  for (const cv::Point2f& p : hull) out.emplace_back(p.x, p.y);
  return out;
}

constexpr std::array<const char*, 4> kSides{"right", "lower", "left", "upper"};

}  // namespace

CaptureGuide::CaptureGuide(const Board& board, cv::Size size, bool stereo, const Options& options)
    : board_(board), size_(size), stereo_(stereo), options_(options), p_board_(board_points(board)) {}

double CaptureGuide::difference(const std::vector<Corner>& a, const std::vector<Corner>& b) const {
  std::map<int, Eigen::Vector2d> at;
  for (const Corner& corner : b) at[corner.index] = corner.pixel;
  double sum = 0;
  int count = 0;
  for (const Corner& corner : a)
    if (const auto other = at.find(corner.index); other != at.end()) {
      sum += (corner.pixel - other->second).norm();
      ++count;
    }
  return count == 0 ? std::numeric_limits<double>::max() : sum / count;
}

std::string CaptureGuide::refusal(const std::optional<FoundBoard>& found, const std::vector<Corner>& before,
                                  double sharpest, const std::string& camera, bool at_once) const {
  if (!found) return "no board" + camera;
  if (at_once) return {};
  if (static_cast<double>(found->corners.size()) < options_.least_points * static_cast<double>(p_board_.size()))
    return "partly seen" + camera + ": " + std::to_string(found->corners.size()) + " of " +
           std::to_string(p_board_.size()) + " points";
  if (found->quality.sharpness < options_.blurred * sharpest)
    return "blurred" + camera + ": sharpness " + readable(found->quality.sharpness, 2) + ", the sharpest view has " +
           readable(sharpest, 2);
  if (options_.moved_px <= 0) return {};
  const double moved = difference(found->corners, before);
  if (before.empty() || moved == std::numeric_limits<double>::max()) return "hold it still" + camera;
  if (moved > options_.moved_px) return "moved" + camera + " by " + readable(moved, 1) + " px: hold it still";
  return {};
}

CaptureGuide::Verdict CaptureGuide::offer(const std::optional<FoundBoard>& left, const std::optional<FoundBoard>& right,
                                          bool at_once) {
  std::string reason = refusal(left, before_[0], sharpest_[0], stereo_ ? " (left)" : "", at_once);
  if (reason.empty() && stereo_) reason = refusal(right, before_[1], sharpest_[1], " (right)", at_once);
  const std::array<const std::optional<FoundBoard>*, 2> images{&left, &right};
  for (std::size_t i = 0; i < 2; ++i) before_[i] = *images[i] ? (*images[i])->corners : std::vector<Corner>{};
  if (!reason.empty()) return {false, reason};
  for (std::size_t i = 0; i < taken_.size() && !at_once; ++i)
    if (difference(left->corners, taken_[i].corners) < options_.alike * size_.width &&
        (lean(left->quality) - lean(taken_[i].quality)).norm() < options_.alike_deg)
      return {false, "too like view " + std::to_string(i + 1)};
  for (std::size_t i = 0; i < 2; ++i)
    if (*images[i]) sharpest_[i] = std::max(sharpest_[i], (*images[i])->quality.sharpness);
  taken_.push_back({left->corners, left->quality});
  information_ += lens_information(left->corners, p_board_, size_);
  return {true, {}};
}

cv::Mat CaptureGuide::seen() const {
  cv::Mat seen = cv::Mat::zeros(options_.rows, options_.columns, CV_8U);
  for (const View& view : taken_)
    for (const Corner& corner : view.corners)
      seen.at<uchar>(cell(corner.pixel.y(), size_.height, options_.rows),
                     cell(corner.pixel.x(), size_.width, options_.columns)) = 1;
  return seen;
}

std::array<int, 4> CaptureGuide::tilted() const {
  std::array<int, 4> tilted{};
  for (const View& view : taken_)
    if (view.quality.tilt_deg >= options_.tilt_deg) ++tilted[static_cast<std::size_t>(quarter(view.quality.turn_deg))];
  return tilted;
}

double CaptureGuide::size_ratio() const {
  double largest = 0, smallest = std::numeric_limits<double>::max();
  for (const View& view : taken_) {
    largest = std::max(largest, view.quality.coverage);
    smallest = std::min(smallest, view.quality.coverage);
  }
  return taken_.empty() ? 1 : std::sqrt(largest / smallest);
}

double CaptureGuide::coverage() const {
  const cv::Mat parts = seen();
  return cv::countNonZero(parts) / static_cast<double>(parts.total());
}

CaptureWish CaptureGuide::next_wish() const {
  using Kind = CaptureWish::Kind;
  if (taken_.empty()) return {Kind::first, "show the whole board, in the middle of the image", "", 0, {}};
  const std::array<int, 4> sides = tilted();
  const auto side = std::min_element(sides.begin(), sides.end()) - sides.begin();
  if (sides[static_cast<std::size_t>(side)] == 0) {
    const std::string name = kSides[static_cast<std::size_t>(side)];
    return {
        Kind::tilt, "tilt the board so that its " + name + " side lies farther away", name, static_cast<int>(side), {}};
  }
  const cv::Mat parts = seen();
  for (int row = 0; row < options_.rows; ++row)
    for (int column = 0; column < options_.columns; ++column)
      if (parts.at<uchar>(row, column) == 0) {
        const std::string where = place(column, row, options_.columns, options_.rows);
        return {Kind::place, "nothing in " + where + ": move the board there", where, 0, {column, row}};
      }
  if (size_ratio() < options_.size_ratio)
    return {Kind::size, "show the board from nearer, or from farther away", "", 0, {}};
  return {};
}

CaptureProgress CaptureGuide::progress() const {
  CaptureProgress out;
  out.views = views(), out.views_wanted = options_.views;
  out.seen = seen();
  const std::array<int, 4> sides = tilted();
  for (std::size_t i = 0; i < sides.size(); ++i) out.tilted[i] = sides[i] > 0;
  out.size_ratio = size_ratio(), out.size_ratio_wanted = options_.size_ratio;
  out.sharpest = sharpest_[0], out.sharp_enough = options_.blurred * sharpest_[0];
  for (const View& view : taken_) out.outlines.push_back(outline(view.corners));
  out.uncertainty = uncertainty(32, 24);
  out.wish = next_wish();
  out.enough = enough();
  return out;
}

double CaptureProgress::coverage() const {
  return seen.empty() ? 0 : cv::countNonZero(seen) / static_cast<double>(seen.total());
}

}  // namespace foresight

#include "calibration/target/capture_guide.hpp"

#include <algorithm>
#include <array>
#include <limits>
#include <map>

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
                                  double sharpest, const std::string& camera) const {
  if (!found) return "no board" + camera;
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

CaptureGuide::Verdict CaptureGuide::offer(const std::optional<FoundBoard>& left,
                                          const std::optional<FoundBoard>& right) {
  std::string reason = refusal(left, before_[0], sharpest_[0], stereo_ ? " (left)" : "");
  if (reason.empty() && stereo_) reason = refusal(right, before_[1], sharpest_[1], " (right)");
  const std::array<const std::optional<FoundBoard>*, 2> images{&left, &right};
  for (std::size_t i = 0; i < 2; ++i) before_[i] = *images[i] ? (*images[i])->corners : std::vector<Corner>{};
  if (!reason.empty()) return {false, reason};
  for (std::size_t i = 0; i < taken_.size(); ++i)
    if (difference(left->corners, taken_[i].corners) < options_.alike * size_.width &&
        (lean(left->quality) - lean(taken_[i].quality)).norm() < options_.alike_deg)
      return {false, "too like view " + std::to_string(i + 1)};
  for (std::size_t i = 0; i < 2; ++i)
    if (*images[i]) sharpest_[i] = std::max(sharpest_[i], (*images[i])->quality.sharpness);
  taken_.push_back({left->corners, left->quality});
  information_ += lens_information(left->corners, p_board_, size_);
  return {true, {}};
}

double CaptureGuide::coverage() const {
  cv::Mat seen = cv::Mat::zeros(options_.rows, options_.columns, CV_8U);
  for (const View& view : taken_)
    for (const Corner& corner : view.corners)
      seen.at<uchar>(cell(corner.pixel.y(), size_.height, options_.rows),
                     cell(corner.pixel.x(), size_.width, options_.columns)) = 1;
  return cv::countNonZero(seen) / static_cast<double>(seen.total());
}

std::string CaptureGuide::wish() const {
  cv::Mat seen = cv::Mat::zeros(options_.rows, options_.columns, CV_8U);
  std::array<int, 4> tilted{};
  double largest = 0, smallest = std::numeric_limits<double>::max();
  for (const View& view : taken_) {
    if (view.quality.tilt_deg >= options_.tilt_deg) ++tilted[static_cast<std::size_t>(quarter(view.quality.turn_deg))];
    largest = std::max(largest, view.quality.coverage);
    smallest = std::min(smallest, view.quality.coverage);
    for (const Corner& corner : view.corners)
      seen.at<uchar>(cell(corner.pixel.y(), size_.height, options_.rows),
                     cell(corner.pixel.x(), size_.width, options_.columns)) = 1;
  }
  if (taken_.empty()) return "show the whole board, in the middle of the image";
  const auto side = static_cast<std::size_t>(std::min_element(tilted.begin(), tilted.end()) - tilted.begin());
  if (tilted[side] == 0) return std::string("tilt the board so that its ") + kSides[side] + " side lies farther away";
  for (int row = 0; row < options_.rows; ++row)
    for (int column = 0; column < options_.columns; ++column)
      if (seen.at<uchar>(row, column) == 0)
        return "nothing in " + place(column, row, options_.columns, options_.rows) + ": move the board there";
  if (std::sqrt(largest / smallest) < options_.size_ratio) return "show the board from nearer, or from farther away";
  return {};
}

}  // namespace foresight

// Which views of a board are worth taking, and which one is missing. Pure logic: no camera, no clock.
//
// A set is enough when the board was seen in every part of the image, tilted away at each of its four
// sides, near and far, in at least `views` views. Besides, the covariance of a lens (fx fy cx cy k1 k2)
// that would follow from the views taken is drawn as the uncertainty of a pixel's direction.
#pragma once

#include <Eigen/Core>
#include <array>
#include <opencv2/core.hpp>
#include <optional>
#include <string>
#include <vector>

#include "calibration/target/find_corners.hpp"

namespace foresight {

/// The view to show next.
struct CaptureWish {
  enum class Kind {
    none,   ///< nothing is missing but, perhaps, views
    first,  ///< anything
    tilt,   ///< `side` farther away: 0 right, 1 lower, 2 left, 3 upper
    place,  ///< the board in `cell` (column, row) of the raster
    size,   ///< nearer or farther away
  };
  Kind kind = Kind::none;
  std::string text;   ///< an imperative clause: "tilt the board so that its left side lies farther away"
  std::string where;  ///< the short of it: "lower", "the upper left corner"
  int side = 0;
  cv::Point cell;
};

/// How far a set has come, as a value that other threads may keep.
struct CaptureProgress {
  int views = 0, views_wanted = 0;
  cv::Mat seen;                  ///< CV_8U, the raster over the left image: 1 where a corner was
  std::array<bool, 4> tilted{};  ///< sides that were tilted away: right, lower, left, upper
  double size_ratio = 1, size_ratio_wanted = 1;
  double sharpest = 0, sharp_enough = 0;               ///< of the left image, 1/px
  std::vector<std::vector<Eigen::Vector2d>> outlines;  ///< of the views taken, px of the left image
  cv::Mat uncertainty;                                 ///< CaptureGuide::uncertainty(32, 24)
  CaptureWish wish;
  bool enough = false;

  double coverage() const;  ///< share of the raster that was seen
};

class CaptureGuide {
 public:
  struct Options {
    int views = 15;             ///< at least; fewer than 10 leave the lens to chance
    int columns = 4, rows = 3;  ///< parts of the image that want a corner each
    double blurred = 0.6;       ///< of the sharpest view so far
    double moved_px = 2;        ///< mean, against the frame before; 0: frames are stills, not a film
    double alike = 0.05;        ///< mean distance of corners to an earlier view's, of the image's width ...
    double alike_deg = 12;      ///< ... and difference of tilt; both must be smaller to be alike
    double tilt_deg = 15;       ///< from which on a view counts as tilted
    double least_points = 0.4;  ///< of the board, where it is partly seen
    double size_ratio = 1.4;    ///< of the largest to the smallest image of the board
  };

  struct Verdict {
    bool taken = false;
    std::string reason;  ///< why not, one clause: "blurred: ...", "too like view 3"
  };

  /// `right`: as wide a set for the second camera of a pair, whose views are judged too.
  CaptureGuide(const Board& board, cv::Size size, bool stereo, const Options& options);
  CaptureGuide(const Board& board, cv::Size size, bool stereo = false) : CaptureGuide(board, size, stereo, Options{}) {}

  /// What the newest frame shows; of a pair, both images. Frames in the order in which they came. `at_once`: the user
  /// asks for it, whatever it is worth; only the board must be there.
  Verdict offer(const std::optional<FoundBoard>& left, const std::optional<FoundBoard>& right = std::nullopt,
                bool at_once = false);

  /// CaptureWish::text of the view to show next.
  std::string wish() const { return next_wish().text; }
  CaptureProgress progress() const;
  bool enough() const { return views() >= options_.views && wish().empty(); }
  int views() const { return static_cast<int>(taken_.size()); }

  /// Share of the parts of the left image that hold a corner.
  double coverage() const;

  /// Standard deviation of a projected direction, px, over a grid of `columns` x `rows` points of the
  /// left image (CV_64F), for corners with their own noise and a lens of usual width; free of the
  /// rotation that a change of the camera's pose takes up. Empty before three views are taken.
  cv::Mat uncertainty(int columns, int rows) const;

 private:
  struct View {
    std::vector<Corner> corners;
    ViewQuality quality;
  };
  CaptureWish next_wish() const;
  cv::Mat seen() const;
  std::array<int, 4> tilted() const;
  double size_ratio() const;
  std::string refusal(const std::optional<FoundBoard>& found, const std::vector<Corner>& before, double sharpest,
                      const std::string& camera, bool at_once) const;
  double difference(const std::vector<Corner>& a, const std::vector<Corner>& b) const;

  Board board_;
  cv::Size size_;
  bool stereo_;
  Options options_;
  std::vector<Eigen::Vector3d> p_board_;
  std::vector<View> taken_;
  std::vector<Corner> before_[2];
  double sharpest_[2] = {0, 0};
  Eigen::Matrix<double, 6, 6> information_ = Eigen::Matrix<double, 6, 6>::Zero();
};

/// Information on fx fy cx cy k1 k2 in one view, its pose eliminated; zero where no pose fits.
Eigen::Matrix<double, 6, 6> lens_information(const std::vector<Corner>& corners,
                                             const std::vector<Eigen::Vector3d>& p_board, cv::Size size);

}  // namespace foresight

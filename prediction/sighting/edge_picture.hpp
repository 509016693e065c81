// Where a picture has edges, which way they run, and its colours.
#pragma once

#include <Eigen/Core>
#include <opencv2/core.hpp>
#include <optional>

namespace foresight {

/// Immutable; any thread.
class EdgePicture {
 public:
  static constexpr double kLeastSlope = 4;  ///< grey levels per pixel: less is no edge

  /// `pixels`: CV_8UC1 or CV_8UC3 (BGR). Throws std::invalid_argument for other types.
  explicit EdgePicture(const cv::Mat& pixels);

  static constexpr std::size_t kLevels = 2;
  static constexpr double kReach[kLevels] = {1, 4};  ///< px: over so much the colours of a level are even

  /// Blue, green and red, all the same of a grey picture; nothing outside.
  std::optional<Eigen::Vector3d> colour(std::size_t level, const Eigen::Vector2d& pixel) const;
  /// Of the channel that changes most there, grey levels per pixel, bilinear; zero outside.
  Eigen::Vector2d slope(const Eigen::Vector2d& pixel) const;
  /// Some edge lies within about 4 px that is crossed along `normal` (unit, either way), to 30 degrees.
  bool edge_near(const Eigen::Vector2d& pixel, const Eigen::Vector2d& normal) const;

 private:
  void find_slopes();
  void spread();

  cv::Mat smooth_[kLevels];  // as `pixels`
  cv::Mat slopes_;           // CV_32FC2
  cv::Mat spread_;           // CV_8UC1, half as large: a bit for each of eight directions, of all edges nearby
};

}  // namespace foresight

// The print that a view leaves in a result, by which `verify` knows it again whatever its file is called.
#pragma once

#include <Eigen/Core>
#include <cmath>
#include <span>
#include <vector>

namespace foresight {

/// Of all points that were found in the images of one instant. Those of the same picture, copied, renamed, stored in
/// another format, or found by another finder, differ by less than kSame; those of a board that moved by far more.
struct ViewPrint {
  static constexpr double kSame = 0.1;  ///< px

  int points = 0;
  Eigen::Vector2d centre_px = Eigen::Vector2d::Zero();
  double spread_px = 0;  ///< RMS distance from the centre

  ViewPrint() = default;
  explicit ViewPrint(std::span<const Eigen::Vector2d> pixels) : points(static_cast<int>(pixels.size())) {
    if (pixels.empty()) return;
    const double count = points;
    for (const Eigen::Vector2d& pixel : pixels) centre_px += pixel / count;
    double squares = 0;
    for (const Eigen::Vector2d& pixel : pixels) squares += (pixel - centre_px).squaredNorm();
    spread_px = std::sqrt(squares / count);
  }

  bool same_as(const ViewPrint& other) const {
    return points > 0 && points == other.points && (centre_px - other.centre_px).norm() < kSame &&
           std::abs(spread_px - other.spread_px) < kSame;
  }
};

using ViewPrints = std::vector<ViewPrint>;

/// Whether one of `known` is `print`.
inline bool knows(const ViewPrints& known, const ViewPrint& print) {
  for (const ViewPrint& each : known)
    if (each.same_as(print)) return true;
  return false;
}

}  // namespace foresight

// Finds triangles that hide each other when seen along an axis.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

namespace foresight {

/// A picture of heights over a plane, 256 cells along its longer side. The first triangle to claim a
/// place keeps it.
class OverlapGrid {
 public:
  /// The rectangle that all triangles lie in, and the difference in height up to which two triangles
  /// count as one surface; all in metres.
  OverlapGrid(const Eigen::Vector2d& lower, const Eigen::Vector2d& upper, double tolerance)
      : lower_(lower), tolerance_(tolerance) {
    const Eigen::Vector2d extent = (upper - lower).cwiseMax(1e-6);
    scale_ = kCells / extent.maxCoeff();
    width_ = static_cast<int>(extent.x() * scale_) + 2;
    heights_.assign(static_cast<std::size_t>(width_) * (static_cast<std::size_t>(extent.y() * scale_) + 2), kNone);
  }

  /// Takes the cells whose centres lie in the triangle with corners `uv` at heights `h`; false, and
  /// nothing is taken, where another surface has one of them.
  bool claim(const std::array<Eigen::Vector2d, 3>& uv, const std::array<double, 3>& h) {
    return visit(uv, h,
                 [&](double& cell, double height) { return cell == kNone || std::abs(cell - height) < tolerance_; }) &&
           visit(uv, h, [&](double& cell, double height) {
             if (cell == kNone) cell = height;
             return true;
           });
  }

 private:
  static constexpr int kCells = 256;  // along the longer side
  static constexpr double kNone = 1e300;

  template <typename F>
  bool visit(const std::array<Eigen::Vector2d, 3>& uv, const std::array<double, 3>& h, F&& f) {
    std::array<Eigen::Vector2d, 3> g;
    for (std::size_t i = 0; i < 3; ++i) g[i] = (uv[i] - lower_) * scale_;
    const double area = (g[1] - g[0]).x() * (g[2] - g[0]).y() - (g[1] - g[0]).y() * (g[2] - g[0]).x();
    if (std::abs(area) < 1e-12) return true;
    const int x0 = static_cast<int>(std::ceil(std::min({g[0].x(), g[1].x(), g[2].x()})));
    const int x1 = static_cast<int>(std::floor(std::max({g[0].x(), g[1].x(), g[2].x()})));
    const int y0 = static_cast<int>(std::ceil(std::min({g[0].y(), g[1].y(), g[2].y()})));
    const int y1 = static_cast<int>(std::floor(std::max({g[0].y(), g[1].y(), g[2].y()})));
    for (int y = y0; y <= y1; ++y) {
      for (int x = x0; x <= x1; ++x) {
        const Eigen::Vector2d d = Eigen::Vector2d(x, y) - g[0];
        const double b1 = (d.x() * (g[2] - g[0]).y() - d.y() * (g[2] - g[0]).x()) / area;
        const double b2 = ((g[1] - g[0]).x() * d.y() - (g[1] - g[0]).y() * d.x()) / area;
        if (b1 < 0 || b2 < 0 || b1 + b2 > 1) continue;
        const double height = h[0] + b1 * (h[1] - h[0]) + b2 * (h[2] - h[0]);
        if (!f(heights_[static_cast<std::size_t>(y) * static_cast<std::size_t>(width_) + static_cast<std::size_t>(x)],
               height))
          return false;
      }
    }
    return true;
  }

  Eigen::Vector2d lower_;
  double tolerance_, scale_ = 1;
  int width_ = 0;
  std::vector<double> heights_;
};

}  // namespace foresight

// Where a polygon's normalised texture lies on it, and how many texels it has (section 4.3).
#pragma once

#include "texture_gpu/thesis/polygons.hpp"

namespace foresight::thesis {

/// x, y and the normal are the polygon's frame (eqs. 4.24 to 4.26), with the origin moved so that
/// all of the polygon has positive coordinates (eq. 4.27).
struct PolygonFrame {
  Eigen::Vector3d origin = Eigen::Vector3d::Zero();  ///< outer corner of texel (0, 0); node frame, metres
  Eigen::Vector3d x = Eigen::Vector3d::UnitX(), y = Eigen::Vector3d::UnitY();
  double width = 0, height = 0;  ///< metres
  int s = 1, t = 1;              ///< texels along x and y: powers of two (eqs. 4.28, 4.29)

  /// Node frame; (0, 0) is the outer corner of the first texel, (0.5, 0.5) its centre.
  Eigen::Vector3d at(double i, double j) const { return origin + x * (i * width / s) + y * (j * height / t); }
  Eigen::Vector2d texel_of(const Eigen::Vector3d& p_node) const {
    return {(p_node - origin).dot(x) * s / width, (p_node - origin).dot(y) * t / height};
  }
};

PolygonFrame frame_of(const Polygon& polygon, double texels_per_metre, int max_texture);

}  // namespace foresight::thesis

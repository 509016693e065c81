// Who looks at a rig from outside: an eye that goes around a point.
#pragma once

#include <Eigen/Geometry>
#include <optional>
#include <string>

#include "scene/scene_model.hpp"

namespace foresight {

enum class LookFrom : std::uint8_t { front, side, top, iso };  ///< from +x, from -y, from +z, from front and above

/// Angles as a camera's on a tripod. Drags are in pixels.
struct Eye {
  Eigen::Vector3d target = Eigen::Vector3d::Zero();  ///< what it looks at, world
  double azimuth = 0;                                ///< rad about z, where the eye stands, from x to y
  double elevation = 0;                              ///< rad above the target's height
  double distance = 2;                               ///< metres, > 0
  bool perspective = true;                           ///< else lines that are parallel stay so, and lengths compare

  /// So that all of `what` (not empty) is in a picture of these proportions (width over height).
  static Eye from(LookFrom side, const Eigen::AlignedBox3d& what, double proportions);

  void orbit(double right_px, double down_px);
  void shift(double right_px, double down_px, int height_px);
  void zoom(double steps);  ///< positive: nearer

  /// Optical frame of the eye: x right, y down, z forward.
  Pose T_world_eye() const;
  /// World to clip space for a picture of that size; row 0 at the top, depth 1 near and 0 far.
  Eigen::Matrix4f clip_from_world(int width, int height) const;
  /// Pixel of a point; nothing behind the eye.
  std::optional<Eigen::Vector2d> pixel(const Eigen::Vector3d& p_world, int width, int height) const;
  /// Metres across a pixel, at the target.
  double metres_per_pixel(int height) const;
};

}  // namespace foresight

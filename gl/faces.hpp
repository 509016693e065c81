// The pinhole pictures into which a scene is rasterised for one lens.
//
// A rasteriser draws straight lines only. So the scene is drawn into pinhole faces that together
// hold all that the lens sees, and the lens model is applied exactly when they are looked up.
//
//   up to 120 degrees: one face, the optical axis its own      beyond: six cube faces
#pragma once

#include <Eigen/Core>
#include <array>

#include "common/lens.hpp"

namespace foresight::gl {

/// Geometry of the faces; all have the same size and intrinsics. Row 0 of a face is its top.
struct Faces {
  int count = 1;                          ///< 1 or 6
  int width = 0, height = 0;              ///< px
  double fx = 0, fy = 0, cx = 0, cy = 0;  ///< px, pixel centres at integers

  /// R_face_camera of face `i`. Cube order: +z +x -z -x +y -y, each face's z axis outwards.
  static Eigen::Matrix3d rotation(int i);
};

/// Faces for `lens`: its own pinhole where it has no distortion, else as many pixels per radian
/// on the axis as the image has, with `border_px` to spare around what the lens sees.
Faces faces_for(const Lens& lens, int border_px);

/// Distance from the camera in front of which nothing is drawn, metres.
inline constexpr double kNearPlane = 0.01;

}  // namespace foresight::gl

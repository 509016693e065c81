// Section 4.1: the part of the camera image that shows a polygon.
#pragma once

#include <optional>

#include "texture_gpu/thesis/camera_frame.hpp"
#include "texture_gpu/thesis/polygons.hpp"

namespace foresight::thesis {

/// Whole pixels of the camera frame.
struct BoundingBox {
  int x = 0, y = 0, width = 0, height = 0;
};

/// The polygon's box in the image, clipped to it (eqs. 4.7 to 4.12) and two pixels wider on all
/// sides, for the border of section 4.5.3. Nothing: out of view, or seen from behind.
std::optional<BoundingBox> bounding_box(const Polygon& polygon, const Pose& T_camera_node, const gl::Faces& plane);

/// Holds one polygon's part of the image at a time.
class PerspectiveTexture {
 public:
  explicit PerspectiveTexture(const gl::Faces& plane);

  /// Copies colour and alpha of the box to the texture's origin.
  void copy(const CameraFrame& frame, const BoundingBox& box) const;

  const gl::Texture& texture() const { return texture_; }

 private:
  gl::Texture texture_;
};

}  // namespace foresight::thesis

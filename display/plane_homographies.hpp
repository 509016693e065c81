// The way of each triangle's plane from a view to an image.
#pragma once

#include "gl/program.hpp"

namespace foresight {

/// One record per triangle in place of the plane, the node and two poses of that, which each pixel of it would look up:
/// homographies.comp. Belongs to the context it was built in.
class PlaneHomographies {
 public:
  PlaneHomographies();

  /// Whether there are so few triangles that this costs less than it saves.
  static bool pay(std::size_t triangles, std::size_t pixels) { return 4 * triangles <= pixels; }

  /// Computes them. Bound are what the shader reads: T_node_camera of the view, SurfaceRecords::triangles(), and
  /// T_image_node (SeenInputs). Then bound to `unit` as a samplerBuffer.
  void update(std::size_t triangles, GLuint unit);

 private:
  gl::Program program_;
  gl::BufferTexture records_;
};

}  // namespace foresight

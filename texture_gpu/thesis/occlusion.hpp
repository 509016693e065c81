// Sections 4.2 and 4.5.3: which pixels of a polygon something else hides.
#pragma once

#include "texture_gpu/thesis/camera_frame.hpp"
#include "texture_gpu/thesis/polygon_buffers.hpp"

namespace foresight::thesis {

/// Codes visibility in the alpha channel of the camera frame: 1 visible, 0 occluded, and 31/32 (left
/// as it is) outside of the polygon. Belongs to one context.
class Occlusion {
 public:
  explicit Occlusion(std::shared_ptr<const PolygonBuffers> polygons);

  /// Marks polygon `index` and, with `line_border`, a line of five pixels around its edges, so that
  /// filters find valid neighbours beyond them.
  void mark(const CameraFrame& frame, std::size_t index, const Pose& T_camera_node, bool line_border) const;

  /// Marks the polygon as visible without looking (section 4.1 alone, figure 4.4).
  void mark_all_visible(const CameraFrame& frame, std::size_t index, const Pose& T_camera_node) const;

 private:
  void draw_border(const CameraFrame& frame, std::size_t index, const Pose& T_camera_node) const;
  void draw_polygon(const CameraFrame& frame, std::size_t index, const Pose& T_camera_node, float tolerance) const;

  std::shared_ptr<const PolygonBuffers> polygons_;
  gl::VertexArray triangles_, no_vertices_;
  gl::Program polygon_, border_;
};

}  // namespace foresight::thesis

#include "texture_gpu/thesis/occlusion.hpp"

namespace foresight::thesis {
namespace {

// Depths are near / z; a fragment counts as visible up to this share behind the stored depth.
constexpr float kSameSurface = 1e-4f;  // rounding
constexpr float kLineOffset = 2e-3f;   // "changes the values only minimally" (section 4.5.3): 2 mm at 1 m
constexpr float kAnyDepth = 1e9f;
constexpr float kLineWidth = 5;  // px

void set_camera(const gl::Program& program, const gl::Faces& plane, const Pose& T_camera_node, float tolerance) {
  program.use();
  program.set("T_face_node", T_camera_node.matrix().cast<float>().eval());
  program.set("face", Eigen::Vector4d(plane.fx, plane.fy, plane.cx, plane.cy).cast<float>().eval());
  program.set("face_size", Eigen::Vector2i(plane.width, plane.height).cast<float>().eval());
  program.set("tolerance", tolerance);
}

}  // namespace

Occlusion::Occlusion(std::shared_ptr<const PolygonBuffers> polygons)
    : polygons_(std::move(polygons)),
      triangles_(polygons_->create_vertex_array()),
      no_vertices_(gl::create_vertex_array("no vertices")),
      polygon_(gl::Program::graphics(shaders(), "raster.vert", "occlusion.frag")),
      border_(gl::Program::graphics(shaders(), "border.vert", "occlusion.frag")) {}

void Occlusion::mark(const CameraFrame& frame, std::size_t index, const Pose& T_camera_node, bool line_border) const {
  frame.bind_alpha();
  glBindTextureUnit(0, frame.depth().name());
  if (line_border) draw_border(frame, index, T_camera_node);
  draw_polygon(frame, index, T_camera_node, kSameSurface);
  glColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
}

void Occlusion::mark_all_visible(const CameraFrame& frame, std::size_t index, const Pose& T_camera_node) const {
  frame.bind_alpha();
  glBindTextureUnit(0, frame.depth().name());
  draw_polygon(frame, index, T_camera_node, kAnyDepth);
  glColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
}

void Occlusion::draw_border(const CameraFrame& frame, std::size_t index, const Pose& T_camera_node) const {
  const PolygonBuffers::Range& range = polygons_->range(index);
  set_camera(border_, frame.plane(), T_camera_node, kLineOffset);
  border_.set("first_corner", range.first_corner);
  border_.set("corner_count", range.corner_count);
  border_.set("line_width", kLineWidth);
  glBindTextureUnit(1, polygons_->corners());
  glBindVertexArray(no_vertices_.name());
  glDrawArrays(GL_TRIANGLES, 0, 6 * range.corner_count);
}

void Occlusion::draw_polygon(const CameraFrame& frame, std::size_t index, const Pose& T_camera_node,
                             float tolerance) const {
  set_camera(polygon_, frame.plane(), T_camera_node, tolerance);
  glBindVertexArray(triangles_.name());
  polygons_->draw(index);
}

}  // namespace foresight::thesis

#include "gl/raster_pass.hpp"

namespace foresight::gl {

FaceImages::FaceImages(const Faces& f, bool with_surface)
    : faces(f), depth(GL_DEPTH_COMPONENT32F, f.width, f.height, f.count, 1, "face depth") {
  if (with_surface) surface = Texture(GL_R32UI, f.width, f.height, f.count, 1, "face surfaces");
}

RasterPass::RasterPass(std::shared_ptr<const SceneBuffers> scene, bool with_surface)
    : scene_(std::move(scene)),
      array_(scene_->create_vertex_array()),
      program_(Program::graphics(gl_shaders(), "raster.vert", with_surface ? "surface_id.frag" : "depth.frag")),
      framebuffer_(create_framebuffer("faces")),
      with_surface_(with_surface) {
  if (!with_surface) {
    glNamedFramebufferDrawBuffer(framebuffer_.name(), GL_NONE);
    glNamedFramebufferReadBuffer(framebuffer_.name(), GL_NONE);
  }
}

std::vector<bool> RasterPass::seen_from(const Pose& T_world_face, const Faces& faces, const SceneState& state) const {
  if (leaves_out_ == LeavesOut::nothing) return std::vector<bool>(scene_->boxes().box.size(), true);
  const ViewPyramid pyramid(T_world_face, (-0.5 - faces.cx) / faces.fx, (faces.width - 0.5 - faces.cx) / faces.fx,
                            (-0.5 - faces.cy) / faces.fy, (faces.height - 0.5 - faces.cy) / faces.fy);
  return visible_nodes(pyramid, scene_->boxes(), state,
                       leaves_out_ == LeavesOut::behind_walls ? scene_->cells() : nullptr);
}

void RasterPass::operator()(const Pose& T_world_camera, const SceneState& state, const FaceImages& target) const {
  const Faces& faces = target.faces;
  program_.use();
  program_.set("face", Eigen::Vector4d(faces.fx, faces.fy, faces.cx, faces.cy).cast<float>().eval());
  program_.set("face_size", Eigen::Vector2i(faces.width, faces.height).cast<float>().eval());
  glBindVertexArray(array_.name());
  glViewport(0, 0, faces.width, faces.height);
  glEnable(GL_DEPTH_TEST);
  glDepthFunc(GL_GREATER);
  const Pose T_camera_world = T_world_camera.inverse();
  triangles_ = 0;
  for (int i = 0; i < faces.count; ++i) {
    glNamedFramebufferTextureLayer(framebuffer_.name(), GL_DEPTH_ATTACHMENT, target.depth.name(), 0, i);
    if (with_surface_)
      glNamedFramebufferTextureLayer(framebuffer_.name(), GL_COLOR_ATTACHMENT0, target.surface.name(), 0, i);
    glBindFramebuffer(GL_FRAMEBUFFER, framebuffer_.name());
    const float no_depth = 0;
    const GLuint no_surface[4] = {};
    glClearNamedFramebufferfv(framebuffer_.name(), GL_DEPTH, 0, &no_depth);
    if (with_surface_) glClearNamedFramebufferuiv(framebuffer_.name(), GL_COLOR, 0, no_surface);

    Pose R_face_camera = Pose::Identity();
    R_face_camera.linear() = Faces::rotation(i);
    const Pose T_face_world = R_face_camera * T_camera_world;
    const std::vector<bool> seen = seen_from(T_face_world.inverse(), faces, state);
    for (const auto& range : scene_->ranges()) {
      const auto node = static_cast<std::size_t>(range.node);
      if (!seen[node] || (!only_.empty() && !only_[node])) continue;
      triangles_ += static_cast<std::size_t>(range.index_count) / 3;
      const Pose T_face_node = T_face_world * state.T_world_node[node];
      program_.set("T_face_node", T_face_node.matrix().cast<float>().eval());
      program_.set("first_triangle", range.first_triangle);
      glDrawElementsBaseVertex(GL_TRIANGLES, range.index_count, GL_UNSIGNED_INT,
                               reinterpret_cast<const void*>(range.first_index * sizeof(std::uint32_t)),
                               range.base_vertex);
    }
  }
  glDisable(GL_DEPTH_TEST);
  glBindVertexArray(0);
  glBindFramebuffer(GL_FRAMEBUFFER, 0);
}

}  // namespace foresight::gl

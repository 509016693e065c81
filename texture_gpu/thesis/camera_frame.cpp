#include "texture_gpu/thesis/camera_frame.hpp"

#include <stdexcept>

namespace foresight::thesis {

bool CameraFrame::can_undistort(const Lens& lens) {
  return gl::faces_for(lens, 0).count == 1;
}

CameraFrame::CameraFrame(const Lens& lens, const std::shared_ptr<const gl::SceneBuffers>& scene)
    : input_(lens, 0),
      raster_(scene, false),
      framebuffer_(gl::create_framebuffer("camera frame")),
      depth_only_(gl::create_framebuffer("camera frame depth")) {
  if (!can_undistort(lens)) throw std::invalid_argument("the lens sees more than one picture plane can hold");
  if (lens.has_distortion()) {
    straight_ = gl::Texture(GL_RGBA8, plane().width, plane().height, 0, 1, "undistorted image");
    undistort_ = texel_program("undistort.frag", {"UNSEEN 0"});
    unseen_ = texel_program("undistort.frag", {"UNSEEN 1"});
  }
  glNamedFramebufferTexture(framebuffer_.name(), GL_COLOR_ATTACHMENT0, colour().name(), 0);
  glNamedFramebufferTextureLayer(depth_only_.name(), GL_DEPTH_ATTACHMENT, depth().name(), 0, 0);
  glNamedFramebufferDrawBuffer(depth_only_.name(), GL_NONE);
}

void CameraFrame::upload(const PosedImage& image) {
  input_.upload(image.pixels);
}

void CameraFrame::load(const TexelDrawing& drawing) {
  if (straight_) {
    drawing.onto(straight_, plane().width, plane().height);
    undistort_.use();
    glBindBufferBase(GL_UNIFORM_BUFFER, 0, input_.block().name());
    glBindTextureUnit(0, input_.image().name());
    drawing.rectangle();
  } else {
    reset_alpha(0, 0, plane().width, plane().height);
  }
}

void CameraFrame::draw_depth(const PosedImage& image, const TexelDrawing& drawing) {
  raster_(image.T_world_camera, image.scene, input_.faces());
  if (!straight_) return;
  fences_();
  glBindFramebuffer(GL_FRAMEBUFFER, depth_only_.name());
  glViewport(0, 0, plane().width, plane().height);
  glEnable(GL_DEPTH_TEST);
  glDepthFunc(GL_ALWAYS);
  unseen_.use();
  glBindBufferBase(GL_UNIFORM_BUFFER, 0, input_.block().name());
  drawing.rectangle();
  glDisable(GL_DEPTH_TEST);
}

void CameraFrame::reset_alpha(int x, int y, int width, int height) const {
  bind_alpha();
  glEnable(GL_SCISSOR_TEST);
  glScissor(x, y, width, height);
  glClearColor(0, 0, 0, kOutsideAlpha);
  glClear(GL_COLOR_BUFFER_BIT);
  glDisable(GL_SCISSOR_TEST);
  glColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
}

void CameraFrame::bind_alpha() const {
  fences_();
  glBindFramebuffer(GL_FRAMEBUFFER, framebuffer_.name());
  glViewport(0, 0, plane().width, plane().height);
  glColorMask(GL_FALSE, GL_FALSE, GL_FALSE, GL_TRUE);
}

}  // namespace foresight::thesis

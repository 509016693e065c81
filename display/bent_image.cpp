#include "display/bent_image.hpp"

#include "display/shaders.hpp"
#include "gl/camera_block.hpp"
#include "gl/lens_rays.hpp"

namespace foresight {

BentImage::BentImage(const Lens& camera)
    : camera_(sizeof(gl::CameraBlock), "camera of an image"),
      straight_(gl::Program::compute(display_and_lookup_shaders(), "bent.comp", {"DISTORTED 0"})),
      distorted_(gl::Program::compute(display_and_lookup_shaders(), "bent.comp", {"DISTORTED 1"})) {
  const gl::CameraBlock block = gl::make_camera_block(camera, gl::faces_for(camera, 2));
  camera_.write(std::span(&block, 1));
}

const gl::Texture& BentImage::operator()(const gl::Texture& image, const Lens& eye) {
  if (!picture_ || picture_.width() != eye.width() || picture_.height() != eye.height()) {
    rays_ = gl::make_lens_rays(eye);
    picture_ = gl::Texture(GL_RGBA8, eye.width(), eye.height(), 0, 1, "bent image");
  }
  const gl::Program& program = eye.has_distortion() ? distorted_ : straight_;
  const Lens::Parameters& p = eye.parameters();
  program.set("eye", Eigen::Vector4d(p.fx, p.fy, p.cx, p.cy).cast<float>().eval());
  glBindBufferBase(GL_UNIFORM_BUFFER, 0, camera_.name());
  glBindTextureUnit(0, image.name());
  glBindTextureUnit(1, rays_.name());
  glBindImageTexture(0, picture_.name(), 0, GL_FALSE, 0, GL_WRITE_ONLY, GL_RGBA8);
  program.dispatch(p.width, p.height);
  glMemoryBarrier(GL_TEXTURE_FETCH_BARRIER_BIT | GL_TEXTURE_UPDATE_BARRIER_BIT | GL_FRAMEBUFFER_BARRIER_BIT);
  return picture_;
}

}  // namespace foresight

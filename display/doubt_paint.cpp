#include "display/doubt_paint.hpp"

#include "display/shaders.hpp"

namespace foresight {

DoubtPaint::DoubtPaint() : program_(gl::Program::compute(display_and_lookup_shaders(), "doubt.comp")) {}

const gl::Texture& DoubtPaint::operator()(const gl::Texture& shown, const gl::Texture& doubt) {
  const int width = shown.width(), height = shown.height();
  if (!picture_ || picture_.width() != width || picture_.height() != height)
    picture_ = gl::Texture(GL_RGBA8, width, height, 0, 1, "painted by doubt");
  program_.use();
  glBindTextureUnit(0, shown.name());
  glBindTextureUnit(1, doubt.name());
  glBindImageTexture(0, picture_.name(), 0, GL_FALSE, 0, GL_WRITE_ONLY, GL_RGBA8);
  glDispatchCompute(gl::groups(width, 8), gl::groups(height, 8), 1);
  glMemoryBarrier(GL_TEXTURE_FETCH_BARRIER_BIT | GL_TEXTURE_UPDATE_BARRIER_BIT | GL_FRAMEBUFFER_BARRIER_BIT);
  return picture_;
}

}  // namespace foresight

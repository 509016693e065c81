#include "display/picture_mix.hpp"

#include <cmath>

#include "display/shaders.hpp"

namespace foresight {

PictureMix::PictureMix() : program_(gl::Program::compute(display_and_lookup_shaders(), "mix.comp")) {}

const gl::Texture& PictureMix::operator()(const gl::Texture& first, const gl::Texture& second, int width, int height,
                                          const Options& options) {
  if (!picture_ || picture_.width() != width || picture_.height() != height)
    picture_ = gl::Texture(GL_RGBA8, width, height, 0, 1, "mixed picture");
  program_.set("way", static_cast<int>(options.way));
  program_.set("size", Eigen::Vector2f(static_cast<float>(width), static_cast<float>(height)));
  program_.set("border", static_cast<int>(std::lround(options.border * width)));
  program_.set("parity", options.odd ? 1 : 0);
  glBindTextureUnit(0, first.name());
  glBindTextureUnit(1, second.name());
  glBindImageTexture(0, picture_.name(), 0, GL_FALSE, 0, GL_WRITE_ONLY, GL_RGBA8);
  program_.dispatch(width, height);
  glMemoryBarrier(GL_TEXTURE_FETCH_BARRIER_BIT | GL_TEXTURE_UPDATE_BARRIER_BIT | GL_FRAMEBUFFER_BARRIER_BIT);
  return picture_;
}

}  // namespace foresight

#include "display/paint_pass.hpp"

#include <algorithm>

#include "display/shaders.hpp"

namespace foresight {

PaintPass::PaintPass(bool levels)
    : program_(gl::Program::compute(display_and_lookup_shaders(), "paint.comp", {"LEVELS " + std::to_string(levels)})) {
}

void PaintPass::operator()(ViewPaint paint, const gl::Texture& picture, const PublishedTextures& textures,
                           RobotTime instant) const {
  glMemoryBarrier(GL_SHADER_IMAGE_ACCESS_BARRIER_BIT);  // the view was stored by the pass before
  program_.set("paint", static_cast<int>(paint));
  program_.set("since", static_cast<float>(std::max(0.0, to_seconds(instant - textures.newest_image))));
  glBindTextureUnit(10, textures.ages.texture());
  glBindImageTexture(0, picture.name(), 0, GL_FALSE, 0, GL_READ_WRITE, GL_RGBA8);
  program_.dispatch(picture.width(), picture.height());
}

}  // namespace foresight

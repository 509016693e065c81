#include "display/warp/block_spread.hpp"

#include "display/warp/warp_layers.hpp"
#include "display/warp/warp_shaders.hpp"

namespace foresight {

BlockSpread::BlockSpread() : program_(gl::Program::compute(gl::warp_shaders(), "spread.comp")) {}

const gl::Texture& BlockSpread::operator()(const WarpLayers& layers, int radius) {
  const Eigen::Vector2i blocks(layers.blocks.width(), layers.blocks.height());
  for (gl::Texture& around : around_)
    if (around.width() != blocks.x() || around.height() != blocks.y())
      around = gl::Texture(GL_RGBA32F, blocks.x(), blocks.y(), 0, 1, "around blocks");
  program_.set("size", blocks);
  program_.set("radius", radius);
  program_.set("of_part", static_cast<int>(layers.of_part));
  for (int pass = 0; pass < 2; ++pass) {
    program_.set("way", Eigen::Vector2i(1 - pass, pass));
    glBindTextureUnit(0, pass == 0 ? layers.blocks.name() : around_[0].name());
    glBindImageTexture(0, around_[static_cast<std::size_t>(pass)].name(), 0, GL_FALSE, 0, GL_WRITE_ONLY, GL_RGBA32F);
    program_.dispatch(blocks.x(), blocks.y());
    glMemoryBarrier(GL_TEXTURE_FETCH_BARRIER_BIT);
  }
  return around_[1];
}

}  // namespace foresight

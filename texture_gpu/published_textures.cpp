#include "texture_gpu/published_textures.hpp"

namespace foresight {

void PublishedTextures::bind() const {
  glBindTextureUnit(11, table.texture());
  glBindTextureUnit(12, charts.texture());
  glBindTextureUnit(13, colours->name());
  glBindTextureUnit(14, coarse.texture());
  glBindTextureUnit(15, means.texture());
}

}  // namespace foresight

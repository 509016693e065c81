#include "texture_gpu/atlas_store.hpp"

#include "common/error.hpp"
#include "gl/context.hpp"
#include "texture_gpu/atlas_layout.hpp"

namespace foresight {
namespace {

/// An array texture for `slots` pages: full layers, or a single one that is only as high as needed.
gl::Texture reserve(GLenum format, std::uint32_t slots, int levels, const char* label) {
  const int layers = static_cast<int>((slots + atlas::kSlotsPerLayer - 1) / atlas::kSlotsPerLayer);
  const int rows = static_cast<int>(slots + atlas::kSlotsPerRow - 1) / atlas::kSlotsPerRow;
  const int height = layers > 1 ? atlas::kLayerHeight : rows * atlas::kPage;
  return gl::Texture(format, atlas::kLayerWidth, height, layers, levels, label);
}

void require_pages(const ChartAtlas& atlas) {
  if (atlas.height_capacity() == 0)
    throw RuntimeFailure("out of texture memory: not one row of pages fits", "give more with --texture-memory-mb");
}

}  // namespace

AtlasStore::AtlasStore(const ChartAtlas& atlas) {
  require_pages(atlas);
  colours = std::make_shared<const gl::Texture>(
      reserve(atlas::kColourFormat, atlas.colour_capacity(), atlas::kLevels, "atlas colours"));
  heights = reserve(GL_R16UI, atlas.height_capacity(), 1, "atlas heights");
  glTextureParameteri(colours->name(), GL_TEXTURE_MIN_FILTER, GL_NEAREST_MIPMAP_NEAREST);
  gl::check_errors("the reservation of texture memory");
}

}  // namespace foresight

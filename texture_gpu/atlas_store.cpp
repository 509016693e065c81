#include "texture_gpu/atlas_store.hpp"

#include "gl/context.hpp"
#include "texture_gpu/atlas_layout.hpp"

namespace foresight {
namespace {

int layers_for(std::uint32_t slots) { return static_cast<int>((slots + atlas::kSlotsPerLayer - 1) / atlas::kSlotsPerLayer); }

}  // namespace

AtlasStore::AtlasStore(const ChartAtlas& atlas)
    : colours(GL_RGBA8, atlas::kLayer, atlas::kLayer, layers_for(atlas.colour_capacity()), atlas::kLevels, "atlas colours"),
      heights(GL_R16UI, atlas::kLayer, atlas::kLayer, layers_for(atlas.height_capacity()), 1, "atlas heights") {
  glTextureParameteri(colours.name(), GL_TEXTURE_MIN_FILTER, GL_NEAREST_MIPMAP_NEAREST);
  gl::check_errors("the reservation of texture memory");
}

}  // namespace foresight

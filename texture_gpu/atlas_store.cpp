#include "texture_gpu/atlas_store.hpp"

#include <algorithm>

#include "common/error.hpp"
#include "gl/context.hpp"
#include "texture_gpu/atlas_layout.hpp"

namespace foresight {
namespace {

constexpr std::uint32_t kFirstSlots = atlas::kSlotsPerLayer / 2;

/// Whole layers, or a single one that is only as high as needed.
struct Extent {
  int layers = 0, height = 0;
  std::uint32_t slots() const {
    return static_cast<std::uint32_t>(layers * (height / atlas::kPage) * atlas::kSlotsPerRow);
  }
};

Extent extent_of(std::uint32_t slots) {
  const int layers = static_cast<int>((slots + atlas::kSlotsPerLayer - 1) / atlas::kSlotsPerLayer);
  const int rows = static_cast<int>(slots + atlas::kSlotsPerRow - 1) / atlas::kSlotsPerRow;
  return {layers, layers > 1 ? atlas::kLayerHeight : rows * atlas::kPage};
}

gl::Texture reserve(GLenum format, std::uint32_t slots, int levels, const char* label) {
  const Extent extent = extent_of(slots);
  const int height = gl::no_power_of_two(extent.height, atlas::kPage);
  return gl::Texture(format, atlas::kLayerWidth, height, extent.layers, levels, label);
}

gl::Texture reserve_colours(std::uint32_t slots) {
  return reserve(atlas::kColourFormat, slots, atlas::kLevels, "atlas colours");
}

gl::Texture reserve_heights(std::uint32_t slots) {
  return reserve(GL_R16UI, slots, 1, "atlas heights");
}

void copy(const gl::Texture& from, const gl::Texture& to, int levels) {
  for (int level = 0; level < levels; ++level)
    glCopyImageSubData(from.name(), GL_TEXTURE_2D_ARRAY, level, 0, 0, 0, to.name(), GL_TEXTURE_2D_ARRAY, level, 0, 0, 0,
                       from.width() >> level, from.height() >> level, from.layers());
}

/// What to hold so that `needed` slots are there, and that this is seldom asked.
std::uint32_t grown(std::uint32_t held, std::uint32_t needed, std::uint32_t capacity) {
  if (needed <= held) return held;
  return std::min(extent_of(std::max(needed, held + held / 2)).slots(), capacity);
}

void require_pages(const ChartAtlas& atlas) {
  if (atlas.height_capacity() == 0)
    throw RuntimeFailure("out of texture memory: not one row of pages fits", "give more with --texture-memory-mb");
}

}  // namespace

AtlasStore::AtlasStore(const ChartAtlas& atlas)
    : capacity_{atlas.colour_capacity(), atlas.height_capacity()},
      held_{std::min(kFirstSlots, capacity_.colours), std::min(kFirstSlots, capacity_.heights)} {
  require_pages(atlas);
  colours = std::make_shared<const gl::Texture>(reserve_colours(held_.colours));
  heights = reserve_heights(held_.heights);
  gl::check_errors("the reservation of texture memory");
}

bool AtlasStore::hold(const ChartAtlas::Slots& slots) {
  const ChartAtlas::Slots next{grown(held_.colours, slots.colours, capacity_.colours),
                               grown(held_.heights, slots.heights, capacity_.heights)};
  try {
    std::shared_ptr<const gl::Texture> more_colours;
    gl::Texture more_heights;
    if (next.colours > held_.colours) {
      more_colours = std::make_shared<const gl::Texture>(reserve_colours(next.colours));
      copy(*colours, *more_colours, atlas::kLevels);
    }
    if (next.heights > held_.heights) {
      more_heights = reserve_heights(next.heights);
      copy(heights, more_heights, 1);
    }
    gl::check_errors("the growth of texture memory");
    if (more_colours) colours = std::move(more_colours);
    if (next.heights > held_.heights) heights = std::move(more_heights);
  } catch (const RuntimeFailure&) {
    return false;
  }
  held_ = next;
  return true;
}

}  // namespace foresight

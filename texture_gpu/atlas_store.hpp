// The atlas in GPU memory, which grows as pages are seen.
#pragma once

#include <memory>

#include "gl/objects.hpp"
#include "texture_gpu/chart_atlas.hpp"

namespace foresight {

namespace atlas {
/// Of texels (texel.hpp). They are fetched as four bytes, the fastest way on software renderers, and stored as one
/// number through an image of the same size.
inline constexpr GLenum kColourFormat = GL_RGBA8, kStoredColourFormat = GL_R32UI;
/// Means of pages and charts, with the alpha of coarse.comp.
inline constexpr GLenum kMeanFormat = GL_RGBA16F;
inline constexpr std::uint64_t kMeanBytes = 8;
}  // namespace atlas

/// Colour slots with their pyramid, and height slots (atlas_layout.hpp). The thread of the texture core.
class AtlasStore {
 public:
  /// Begins with a part of what `atlas` may ever hold. Throws RuntimeFailure where the GPU cannot hold it.
  explicit AtlasStore(const ChartAtlas& atlas);

  /// Makes room for the first so many slots, at least half as many again as before where it grows. What was there
  /// stays; generations that were published go on with the texture they have, so that for a moment both are held. False
  /// where the GPU has no memory for it: all is as before.
  bool hold(const ChartAtlas::Slots& slots);
  ChartAtlas::Slots held() const { return held_; }

  /// R32UI array, atlas::kLevels levels; published generations own it too.
  std::shared_ptr<const gl::Texture> colours;
  gl::Texture heights;  ///< R16UI array

 private:
  ChartAtlas::Slots capacity_, held_;
};

}  // namespace foresight

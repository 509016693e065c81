// The atlas in GPU memory, reserved once.
#pragma once

#include <memory>

#include "gl/objects.hpp"
#include "texture_gpu/chart_atlas.hpp"

namespace foresight {

namespace atlas {
/// Colours are halves: a texel may be brighter than white at the reference exposure, and one of a
/// dark image keeps its 256 steps (docs/decisions/0015).
inline constexpr GLenum kColourFormat = GL_RGBA16F;
}  // namespace atlas

/// Colour slots with their pyramid, and height slots (atlas_layout.hpp). Throws RuntimeFailure
/// where the GPU cannot hold them.
struct AtlasStore {
  explicit AtlasStore(const ChartAtlas& atlas);
  /// RGBA16F array, atlas::kLevels levels; published generations own it too.
  std::shared_ptr<const gl::Texture> colours;
  gl::Texture heights;  ///< R16UI array
};

}  // namespace foresight

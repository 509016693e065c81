// The atlas in GPU memory, reserved once.
#pragma once

#include <memory>

#include "gl/objects.hpp"
#include "texture_gpu/chart_atlas.hpp"

namespace foresight {

/// Colour slots with their pyramid, and height slots (atlas_layout.hpp). Throws RuntimeFailure
/// where the GPU cannot hold them.
struct AtlasStore {
  explicit AtlasStore(const ChartAtlas& atlas);
  /// RGBA8 array, atlas::kLevels levels; published generations own it too.
  std::shared_ptr<const gl::Texture> colours;
  gl::Texture heights;  ///< R16UI array
};

}  // namespace foresight

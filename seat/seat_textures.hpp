// What a seat makes of images, unless it is asked for something else.
#pragma once

#include "texture_gpu/options.hpp"

namespace foresight {

inline const TextureOptions kSeatTextures{.accumulate = std::nullopt};  ///< accumulate: where it is worth its time

/// No image waits for the lamp.
inline TextureOptions in_real_time(TextureOptions textures) {
  textures.awaits_lamp = false;
  return textures;
}

}  // namespace foresight

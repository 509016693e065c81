// What the passes of warping share.
#pragma once

#include "gl/program.hpp"

namespace foresight {

constexpr int kWarpBlock = 8;  ///< px, as in the shaders

constexpr int warp_blocks(int pixels) {
  return (pixels + kWarpBlock - 1) / kWarpBlock;
}

namespace gl {
const ShaderSources& warp_shaders();
}  // namespace gl

}  // namespace foresight

// Where each pixel of a lens looks, as a texture.
#pragma once

#include "common/lens.hpp"
#include "gl/objects.hpp"

namespace foresight::gl {

/// RGBA32F, one texel per pixel: unit direction in the camera frame, to 0.001 px, and 1; all 0 where the lens
/// sees nothing. For a lens without distortion a single texel: shaders use the pinhole formula.
Texture make_lens_rays(const Lens& lens);

}  // namespace foresight::gl

// For passes that compare an image with the one before it.
#pragma once

#include "gl/program.hpp"
#include "texture_gpu/published_image.hpp"
#include "texture_gpu/seen_inputs.hpp"

namespace foresight {

inline constexpr GLuint kRaysUnit = 7;  // after those of SeenInputs (image_point.glsl)

/// Binds `newest` as camera 0, `before` as camera 1, both at the exposure of the textures, the rays of the one and
/// T_before_newest. `both` must live until the pass has run.
void bind_with_before(SeenInputs& both, const gl::Program& program, const PublishedImage& newest,
                      const PublishedImage& before);

}  // namespace foresight

// The display's shaders.
#pragma once

#include "gl/program.hpp"

namespace foresight::gl {

/// The display's own.
const ShaderSources& display_shaders();

}  // namespace foresight::gl

namespace foresight {

/// And those of the texture lookup.
const gl::ShaderSources& display_and_lookup_shaders();

}  // namespace foresight

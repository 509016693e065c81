// The display's own shaders and those of the texture lookup.
#pragma once

#include "gl/program.hpp"

namespace foresight {

const gl::ShaderSources& display_and_lookup_shaders();

}  // namespace foresight

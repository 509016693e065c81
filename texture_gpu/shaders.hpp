// The embedded shaders of this module.
#pragma once

#include "gl/program.hpp"

namespace foresight::gl {
const ShaderSources& texture_gpu_shaders();
}

#include "display/shaders.hpp"

#include "texture_gpu/shaders.hpp"

namespace foresight {

const gl::ShaderSources& display_and_lookup_shaders() {
  static const gl::ShaderSources all = [] {
    gl::ShaderSources s = gl::display_shaders();
    s.insert(gl::texture_gpu_shaders().begin(), gl::texture_gpu_shaders().end());
    return s;
  }();
  return all;
}

}  // namespace foresight

// Section 5.2.5: holes are filled from their borders inwards, one texel per pass.
#pragma once

#include "texture_gpu/thesis/polygon_textures.hpp"

namespace foresight::thesis {

/// Belongs to one context.
class ShaderFilling {
 public:
  explicit ShaderFilling(int max_texture);

  struct Method {
    bool two_stages = true;  ///< eqs. 5.28, 5.29; else only eqs. 5.26, 5.27
    bool query = true;       ///< stop when a pass changes nothing
  };

  /// Fills the texels of `texture` (s x t) whose alpha is 0; alpha stays as it was. Returns the
  /// number of passes. With the query it waits for the GPU, though never for the pass just begun.
  int operator()(const gl::Texture& texture, int s, int t, Method method, const TexelDrawing& drawing);

 private:
  gl::Texture frame_, previous_;  // what is drawn into, and its copy that the shader reads
  gl::Program one_stage_, two_stages_, restore_;
  gl::Query queries_[2];
};

}  // namespace foresight::thesis

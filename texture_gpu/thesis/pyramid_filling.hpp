// Sections 5.2.2 to 5.2.4: holes are filled from a pyramid of the valid texels' means.
#pragma once

#include "texture_gpu/thesis/polygon_textures.hpp"

namespace foresight::thesis {

/// Belongs to one context.
class PyramidFilling {
 public:
  explicit PyramidFilling(int max_texture);

  /// Fills the texels of `texture` (s x t) whose alpha is 0; alpha stays as it was.
  void operator()(const gl::Texture& texture, int s, int t, const TexelDrawing& drawing) const;

 private:
  std::vector<gl::Texture> levels_;  // RGBA8; [0] is half the size of the largest texture
  gl::Program reduce_, expand_;
};

}  // namespace foresight::thesis

// Section 5.1: invalid areas grow, since colours next to them are uncertain.
#pragma once

#include "texture_gpu/thesis/perspective_texture.hpp"
#include "texture_gpu/thesis/thesis_options.hpp"

namespace foresight::thesis {

/// Changes the alpha mask of a perspective texture. Belongs to one context.
class ExpansionPass {
 public:
  explicit ExpansionPass(const gl::Faces& plane);

  /// Textures with a side below this keep their mask: they would lose all of their colour (section 5.1.2).
  static constexpr int kSmallest = 16;  // texels; the thesis says "very small"

  void operator()(const PerspectiveTexture& texture, const BoundingBox& box, Expansion method, int iterations,
                  const TexelDrawing& drawing) const;

 private:
  void dilate(const PerspectiveTexture& texture, const BoundingBox& box, int iterations,
              const TexelDrawing& drawing) const;
  void scale(const PerspectiveTexture& texture, const BoundingBox& box, bool progressive, int iterations,
             const TexelDrawing& drawing) const;

  void write_back(const gl::Texture& mask, const PerspectiveTexture& texture, const BoundingBox& box,
                  const TexelDrawing& drawing) const;

  gl::Texture masks_[2];  // R8
  gl::Program dilate_, halve_, double_, copy_;
};

}  // namespace foresight::thesis

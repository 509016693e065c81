// Section 4.4: newer colours go over older ones.
#pragma once

#include "texture_gpu/thesis/normalisation.hpp"
#include "texture_gpu/thesis/polygon_textures.hpp"

namespace foresight::thesis {

/// Belongs to one context.
class Fusion {
 public:
  Fusion() : program_(texel_program("fuse.frag")) {}

  /// Draws the valid texels of the new texture over the polygon's own. The thesis draws the old one
  /// first, then the new one; where the old one is itself the target, the first drawing is not needed.
  void operator()(const Normalisation& fresh, std::size_t polygon, PolygonTextures& textures,
                  const TexelDrawing& drawing) const {
    const PolygonFrame& frame = textures.frame(polygon);
    drawing.onto(textures.writable(polygon), frame.s, frame.t);
    program_.use();
    glBindTextureUnit(0, fresh.texture().name());
    textures.begin_looking(polygon);
    drawing.rectangle();
    textures.end_looking();
  }

 private:
  gl::Program program_;
};

}  // namespace foresight::thesis

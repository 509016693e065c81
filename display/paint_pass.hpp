// A drawn view painted by what is known of its textures: wireframe, age, confidence.
#pragma once

#include "display/view_modes.hpp"
#include "gl/program.hpp"
#include "texture_gpu/published_textures.hpp"

namespace foresight {

/// Belongs to one context.
class PaintPass {
 public:
  /// `levels`: the views that it paints have some (scene_raster.hpp).
  explicit PaintPass(bool levels);
  /// Over `picture`, the view of `instant` that PredictedView has just drawn: what it bound for that is bound still.
  /// Not for ViewPaint::colours and doubt.
  void operator()(ViewPaint paint, const gl::Texture& picture, const PublishedTextures& textures,
                  RobotTime instant) const;

 private:
  gl::Program program_;
};

}  // namespace foresight

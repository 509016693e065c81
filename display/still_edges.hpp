// Edges of a view that looks from where the newest image was taken, as that image has them.
#pragma once

#include "gl/program.hpp"
#include "texture_gpu/published_image.hpp"
#include "texture_gpu/seen_inputs.hpp"
#include "texture_gpu/work_list.hpp"

namespace foresight {

/// Nothing changes where the view looks from elsewhere. Belongs to the context it was built in.
class StillEdges {
 public:
  /// Lenses of the view and of the image. `levels`: of a scene that is drawn with levels.
  StillEdges(const Lens& view, const Lens& image, bool levels);

  /// Whether any edge may look the same from both places.
  static bool may_be_seen(const PublishedImage& image, const Pose& T_world_view);

  /// Into the picture, at `tiles` (SilhouettePass::tiles()). All that view.glsl needs is bound, but for the image;
  /// `view_depth`: of the view's faces.
  void operator()(const PublishedImage& image, const SeenInputs& inputs, const Pose& T_world_view,
                  const gl::Texture& view_depth, const WorkList& tiles) const;

 private:
  gl::Program program_;
};

}  // namespace foresight

// Edges of a view's surfaces, mixed as a camera mixes them.
#pragma once

#include "gl/raster_pass.hpp"
#include "texture_gpu/work_list.hpp"

namespace foresight {

/// Pixels at which one surface ends before another take a weighted mean of the colours around them (silhouettes.comp).
/// What a pixel counts as (PredictedView::picture()) stays. Belongs to the context it was built in.
class SilhouettePass {
 public:
  explicit SilhouettePass(const Lens& lens);

  /// What was drawn. `camera`: a gl::CameraBlock of `lens` and the faces; `rays`: of make_lens_rays().
  struct View {
    const Lens& lens;  ///< of the kind that the pass was built for
    const gl::Buffer& camera;
    const gl::FaceImages& faces;
    const gl::Texture& rays;
    const gl::Texture& picture;  ///< RGBA8
  };
  void operator()(const View& view);

  /// Of 4x4 pixels, all that may hold silhouettes in the last view: x and 65,536 y of the first of each.
  const WorkList& tiles() const { return tiles_; }

 private:
  static void start(const gl::Program& program, const View& view);
  void find_steps(const View& view);
  void find_pixels(const View& view);

  gl::Program steps_of_faces_, find_tiles_, find_pixels_, mix_, put_;
  WorkList tiles_, pixels_;
  gl::Texture steps_;  // R8, of each 4x4 tile of the faces
  gl::BufferTexture means_;
};

}  // namespace foresight

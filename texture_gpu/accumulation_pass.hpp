// Images as means over time: less of the sensor's noise, and of what falls between pixels, is left in what views show.
#pragma once

#include "gl/program.hpp"
#include "gl/scene_buffers.hpp"
#include "texture_gpu/published_image.hpp"
#include "texture_gpu/seen_inputs.hpp"

namespace foresight {

/// Takes each image together with the one before it, which was so taken together with those before (temporal
/// accumulation). One context, one lens.
class AccumulationPass {
 public:
  /// `scene`: whose nodes' boxes tell where something has moved.
  AccumulationPass(const Lens& lens, std::shared_ptr<const gl::SceneBuffers> scene);

  /// Changes newest.camera's image, of which all but PublishedImage::still is known. `before`: an image of the same
  /// camera, taken earlier; where it is not earlier, or in another light, nothing is done.
  void operator()(PublishedImage& newest, const PublishedImage& before);

 private:
  std::shared_ptr<const gl::SceneBuffers> scene_;
  gl::Program program_;
  SeenInputs both_;
  gl::BufferTexture moved_;
  gl::Texture mean_;
};

}  // namespace foresight

// For how long surfaces have looked as they do in the newest image: what older images show of them is not out of date.
#pragma once

#include "gl/program.hpp"
#include "texture_gpu/published_image.hpp"
#include "texture_gpu/seen_inputs.hpp"

namespace foresight {

/// Compares each image with the one before it, whose camera saw from nearly the same place: gloss then has hardly
/// moved, while what changes does so within an image or two. One context, one lens.
class StillPass {
 public:
  explicit StillPass(const Lens& lens);

  /// Fills newest.still, from its image and all else of it. `before`: an image of the same camera; null, later than
  /// `newest`, or without PublishedImage::still of its own: nothing is known of what was before.
  void operator()(PublishedImage& newest, const PublishedImage* before);

 private:
  gl::Program program_;
  SeenInputs both_;
};

}  // namespace foresight

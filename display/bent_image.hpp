// A camera's image as another lens shows it: its pixels in the directions in which the camera saw them.
#pragma once

#include "common/lens.hpp"
#include "gl/objects.hpp"
#include "gl/program.hpp"

namespace foresight {

/// Belongs to one context.
class BentImage {
 public:
  /// Of images through `camera`.
  explicit BentImage(const Lens& camera);

  /// `image`: RGBA8, all that the camera saw, of any number of pixels. A picture, RGBA8 and opaque, as an eye with the
  /// lens `eye` sees it that stands where the camera stood; black where the camera saw nothing. Lenses of one size are
  /// taken to be one. Valid until the next call.
  const gl::Texture& operator()(const gl::Texture& image, const Lens& eye);

 private:
  gl::Buffer camera_;
  gl::Program straight_, distorted_;  // for an eye without a distortion, and with one
  gl::Texture rays_, picture_;
};

}  // namespace foresight

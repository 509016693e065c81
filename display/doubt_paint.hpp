// A view painted by how far each of its pixels may be off: ViewPaint::doubt.
#pragma once

#include "gl/program.hpp"

namespace foresight {

/// Belongs to one context.
class DoubtPaint {
 public:
  DoubtPaint();
  /// `shown` (RGBA8) and `doubt` (TrustPass::doubt()) have the same size. Valid until the next call.
  const gl::Texture& operator()(const gl::Texture& shown, const gl::Texture& doubt);

 private:
  gl::Program program_;
  gl::Texture picture_;
};

}  // namespace foresight

// A view painted by how often pixels such as each of its own are wrong: ViewPaint::doubt.
#pragma once

#include "display/doubt_kinds.hpp"
#include "gl/program.hpp"

namespace foresight {

/// Which class of classes.glsl a pixel of that doubt is of: 0 to kRarelyWrong, 1 to kOftenWrong, 2 beyond; 3: not
/// known.
unsigned class_of(std::size_t doubt, const KindRisks& risks);

/// Belongs to one context.
class DoubtPaint {
 public:
  DoubtPaint();
  /// `shown` (RGBA8) and `doubt` (TrustPass::doubt()) have the same size. Valid until the next call.
  const gl::Texture& operator()(const gl::Texture& shown, const gl::Texture& doubt, const KindRisks& risks);

 private:
  gl::Program program_;
  gl::Texture picture_;
};

}  // namespace foresight

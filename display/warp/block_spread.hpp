// What the blocks of layers hold, and those around them.
#pragma once

#include <array>

#include "gl/program.hpp"

namespace foresight {

struct WarpLayers;

/// Belongs to one context.
class BlockSpread {
 public:
  BlockSpread();

  /// RGBA32F, a texel a block: largest and smallest inverse depth of all blocks up to `radius` blocks away, and 1 where
  /// surfaces part in any of them. Valid until the next call.
  const gl::Texture& operator()(const WarpLayers& layers, int radius);
  const gl::Texture& last() const { return around_[1]; }

 private:
  gl::Program program_;
  std::array<gl::Texture, 2> around_;  // along rows; then along columns, too
};

}  // namespace foresight

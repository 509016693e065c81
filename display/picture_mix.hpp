// Two pictures in one: split, interlaced, or for red-cyan spectacles.
#pragma once

#include "gl/program.hpp"

namespace foresight {

/// Belongs to one context.
class PictureMix {
 public:
  enum class Way : std::uint8_t {
    split,             ///< the first left of the border
    rows,              ///< in turn
    anaglyph,          ///< red: luma of the first; green, blue: luma of the second
    anaglyph_colours,  ///< red: luma of the first; green, blue: those of the second
  };
  struct Options {
    Way way = Way::split;
    double border = 0.5;  ///< share of the width
    bool odd = false;     ///< the first has the odd rows
  };

  PictureMix();
  /// A picture of width x height px of two of any size (RGBA8), each scaled to it linearly. Valid until the next call.
  const gl::Texture& operator()(const gl::Texture& first, const gl::Texture& second, int width, int height,
                                const Options& options);

 private:
  gl::Program program_;
  gl::Texture picture_;
};

}  // namespace foresight

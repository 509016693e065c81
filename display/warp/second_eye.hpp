// The other eye's picture from that of the first, row by row: the eyes stand beside each other and look the same way,
// so that a point lies in the same row of both, farther to the side the nearer it is.
//
// Along the row from the side that the other eye is not on, what comes later hides what was there, as it is nearer
// (occlusion-compatible order: McMillan 1997): each row is walked once, without a depth test. Where a far surface comes
// out from behind a near one, the first eye has not seen it: such holes get its colour, and are told of.
#pragma once

#include <cstdint>

#include "common/lens.hpp"
#include "display/warp/gpu_count.hpp"
#include "gl/program.hpp"
#include "scene/scene_model.hpp"

namespace foresight {

/// Belongs to one context.
class SecondEye {
 public:
  /// Both without distortion. Throws std::invalid_argument where rows of one are not rows of the other.
  SecondEye(const Lens& first, const Lens& second);

  /// Rows of the second lens are rows of the first, and the second stands to the side of the first.
  static bool fits(const Lens& first, const Lens& second, const Pose& T_first_second);

  /// `picture` and `depth` of the first: DepthWarp::picture() and depth(). `side`: m, x of the second in the first.
  void operator()(const gl::Texture& picture, const gl::Texture& depth, double side);

  const Lens& lens() const { return second_; }
  /// Share of pixels that the first eye had not seen, of a call before the last one: nobody waits for it. 0 at first.
  double unseen() const { return count_.value() / (static_cast<double>(second_.width()) * second_.height()); }
  /// As DepthWarp::picture() and holes().
  const gl::Texture& picture() const { return picture_; }
  const gl::Texture& holes() const { return holes_; }

 private:
  Lens first_, second_;
  gl::Program program_;
  gl::Texture picture_, holes_;
  GpuCount count_;
};

}  // namespace foresight

// A drawn picture, seen from where the head is by now: colour and depth are enough, the scene is not drawn again.
//
//   source (drawn a while ago)        target (now)
//        .---- s(w) ----.      each pixel's ray, as the source sees it, is a line; along it, from near to far, the
//        first |     *  .  .  |      place where the ray meets the surface that the source shows there is what the
//        pixel sees
//        '--------------'
//
// Where the ray only passes behind something that hides the rest from the source, nobody knows: such holes are filled
// with the farthest surface along the line, and told of. (Image warping after McMillan 1997, as a search in the source:
// Bowles et al., "Iterative Image Warping", 2012.)
#pragma once

#include "common/lens.hpp"
#include "gl/program.hpp"
#include "gl/raster_pass.hpp"

namespace foresight {

/// A picture with a depth for each pixel, through a lens without distortion; borrowed.
struct WarpSource {
  const gl::Texture* picture = nullptr;  ///< RGBA8 as PredictedView has it
  const gl::Texture* depth = nullptr;    ///< gl::FaceImages::depth, one face of the same size
  Lens lens;
  Pose T_world_camera = Pose::Identity();
};

/// Belongs to one context.
class DepthWarp {
 public:
  /// `target`: without distortion. Throws std::invalid_argument.
  explicit DepthWarp(const Lens& target);

  /// Draws what the target sees from `T_world_camera` into picture(). The camera moved less than `16 px` of parallax:
  /// what moved farther is searched within that reach. Throws std::invalid_argument: a source with distortion, or whose
  /// textures have another size than its lens.
  void operator()(const WarpSource& source, const Pose& T_world_camera);

  /// RGBA8 as the source's: alpha 255 seen, 128 filled, 64 no colour, 0 no model or beyond the source's border.
  const gl::Texture& picture() const { return picture_; }
  /// R8, the same size: 0 found in the source; 128 a hole that was filled; 255 beyond the source's border.
  const gl::Texture& holes() const { return holes_; }

 private:
  void find_reach(const WarpSource& source);

  Lens target_;
  gl::Program blocks_, spread_, warp_;
  gl::Texture near_far_, reach_;  // RG32F a block: largest and smallest inverse depth
  gl::Texture picture_, holes_;
};

}  // namespace foresight

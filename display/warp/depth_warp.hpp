// A drawn picture, seen from where the head is by now: colour and depth are enough, the scene is not drawn again.
//
//   source (drawn a while ago)        target (now)
//        .---- s(w) ----.      each pixel's ray, as the source sees it, is a line; along it, from near to far, the
//        first |     *  .  .  |      place where the ray meets the surface that the source shows there is what the
//        pixel sees
//        '--------------'
//
// Where the ray only passes behind something that hides the rest from the source, it does not know: such holes are
// looked up in layers of what lies behind its edges, where there are some; else they are filled with the farthest
// surface along the line, and told of. A part that has moved since has a line of its own, on which only its own pixels
// count. Most tiles of the target see one surface, whatever their rays meet: there nothing is searched. (Image warping
// after McMillan 1997, as a search in the source: Bowles et al., "Iterative Image Warping", 2012.)
#pragma once

#include <array>
#include <optional>
#include <span>

#include "display/warp/block_spread.hpp"
#include "display/warp/gpu_count.hpp"
#include "display/warp/warp_layers.hpp"

namespace foresight {

/// Belongs to one context.
class DepthWarp {
 public:
  /// `target`: any lens, such as that of a head display's panel (calibration/display_lens): its distortion is part of
  /// the same pass; up to 85 degrees from straight ahead. `tells`: holes() and depth() are asked for.
  DepthWarp(std::shared_ptr<const WarpScene> scene, const Lens& target, bool tells = true);

  /// Draws what the target sees from `T_world_camera` into picture(), nodes at `T_world_node`: as many as the source
  /// has, or none: they stand as they stood. At most 16 that moved are followed, those nearest to the camera; others
  /// stand as they stood. Surfaces moved by at most 80 px of parallax are found.
  void operator()(const WarpLayers& source, const Pose& T_world_camera, std::span<const Pose> T_world_node = {});

  /// Of several sources that look different ways: clear(), then each is added where it sees what the target sees; a
  /// hole of one is filled by another that has seen what is there.
  void clear();
  void add(const WarpLayers& source, const Pose& T_world_camera, std::span<const Pose> T_world_node = {});

  /// After any of the above: holes that `behind` shows, layers of what the source hides behind its edges
  /// (LayerCapture::behind_edges), are no longer ones. The second: likewise of another picture through the same lens,
  /// such as a second eye's. Where it tells.
  void mend(const WarpLayers& behind, const Pose& T_world_camera, std::span<const Pose> T_world_node = {});
  void mend(const WarpLayers& behind, const Pose& T_world_camera, std::span<const Pose> T_world_node,
            const gl::Texture& picture, const gl::Texture& holes);

  /// Share of pixels that were mended in a call before the last one: nobody waits for it. 0 at first.
  double mended() const { return mended_.value() / (static_cast<double>(target_.width()) * target_.height()); }

  const Lens& lens() const { return target_; }
  bool tells() const { return tells_; }
  /// RGBA8 as the source's: alpha as in pictures/view_alpha.hpp, kNoModel beyond the source's border, or where
  /// the target's lens sees nothing.
  const gl::Texture& picture() const { return picture_; }
  /// Where it tells. R8, the same size: 0 found in the source; 128 a hole that was filled; 255 beyond the source's
  /// border.
  const gl::Texture& holes() const { return holes_; }
  /// Where it tells. R32F, the same size: 1 / z in 1/m, as WarpLayers::depth.
  const gl::Texture& depth() const { return depth_; }

 private:
  /// Of the target, 8 x 8 px each.
  enum class Tiles : std::size_t { smooth, searched, moved };

  struct Programs {
    gl::Program smooth, searched;
    std::optional<gl::Program> moved;  // once it is needed
  };

  void warp(const WarpLayers& source, const Pose& T_world_camera, std::span<const Pose> T_world_node, bool keeps);
  int find_moved(const WarpLayers& source, const Pose& T_world_camera, std::span<const Pose> T_world_node);
  void spread(const WarpLayers& source, const Pose& T_source_target);
  void bind(const WarpLayers& source) const;
  void bind_moved(const gl::Program& program, const WarpLayers& source, int moved) const;
  void list_holes(const gl::Texture& holes);
  void aim(const gl::Program& program, const WarpLayers& source, const Pose& T_source_target) const;
  void list_tiles(const WarpLayers& source, const Pose& T_source_target, int moved, bool keeps);
  void work_off(Tiles which, const gl::Program& program, const WarpLayers& source, const Pose& T_source_target) const;

  enum class Writes { all, what_others_have_not, holes };
  gl::Program warp_program(bool searched, bool moved, Writes what) const;

  std::shared_ptr<const WarpScene> scene_;
  Lens target_;
  bool tells_, distorted_;
  gl::Texture rays_;  // of the target, where it is distorted
  BlockSpread reach_;
  gl::Program tiles_;
  std::array<std::optional<Programs>, 2> programs_;  // once they are needed; the second keeps what is there
  std::array<gl::Program, 2> mending_;               // likewise; the second where nodes have moved
  gl::Program hole_tiles_;                           // with them
  GpuCount mended_;
  std::array<gl::BufferTexture, 3> lists_;  // of Tiles: groups to dispatch, then a tile each
  gl::BufferTexture corners_;               // of tiles of one surface, in the list's order: inverse depths
  gl::BufferTexture slot_of_node_, moved_;
  gl::Texture picture_, holes_, depth_;
};

}  // namespace foresight

// A drawn picture, seen from where the head is by now: colour and depth are enough, the scene is not drawn again.
//
//   source (drawn a while ago)        target (now)
//        .---- s(w) ----.      each pixel's ray, as the source sees it, is a line; along it, from near to far, the
//        first |     *  .  .  |      place where the ray meets the surface that the source shows there is what the
//        pixel sees
//        '--------------'
//
// Where the ray only passes behind something that hides the rest from the source, nobody knows: such holes are filled
// with the farthest surface along the line, and told of. A part that has moved since has a line of its own, on which
// only its own pixels count. Most tiles of the target see one surface, whatever their rays meet: there nothing is
// searched. (Image warping after McMillan 1997, as a search in the source: Bowles et al., "Iterative
// Image Warping", 2012.)
#pragma once

#include <array>
#include <optional>
#include <span>

#include "display/warp/warp_layers.hpp"

namespace foresight {

/// Belongs to one context.
class DepthWarp {
 public:
  /// `target`: without distortion. `tells`: holes() and depth() are asked for. Throws std::invalid_argument.
  DepthWarp(std::shared_ptr<const WarpScene> scene, const Lens& target, bool tells = true);

  /// Draws what the target sees from `T_world_camera` into picture(), nodes at `T_world_node`: as many as the source
  /// has, or none: they stand as they stood. At most 16 that moved are followed, those nearest to the camera; others
  /// stand as they stood. Surfaces moved by at most 80 px of parallax are found.
  void operator()(const WarpLayers& source, const Pose& T_world_camera, std::span<const Pose> T_world_node = {});

  /// Of several sources that look different ways: clear(), then each is added where it sees what the target sees; a
  /// hole of one is filled by another that has seen what is there.
  void clear();
  void add(const WarpLayers& source, const Pose& T_world_camera, std::span<const Pose> T_world_node = {});

  const Lens& lens() const { return target_; }
  /// RGBA8 as the source's: alpha 255 seen, 128 filled, 64 no colour, 0 no model or beyond the source's border.
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
  void aim(const gl::Program& program, const WarpLayers& source, const Pose& T_source_target) const;
  void list_tiles(const WarpLayers& source, const Pose& T_source_target, int moved, bool keeps);
  void work_off(Tiles which, const gl::Program& program, const WarpLayers& source, const Pose& T_source_target) const;

  std::shared_ptr<const WarpScene> scene_;
  Lens target_;
  bool tells_;
  gl::Program spread_, tiles_;
  std::array<std::optional<Programs>, 2> programs_;  // once they are needed; the second keeps what is there
  std::array<gl::Texture, 2> reach_;                 // along rows; then along columns, too
  std::array<gl::BufferTexture, 3> lists_;           // of Tiles: groups to dispatch, then a tile each
  gl::BufferTexture corners_;                        // of tiles of one surface, in the list's order: inverse depths
  gl::BufferTexture slot_of_node_, moved_;
  gl::Texture picture_, holes_, depth_;
};

}  // namespace foresight

// What warping needs of a drawn view, kept after the view has gone on.
#pragma once

#include <memory>
#include <vector>

#include "common/lens.hpp"
#include "display/warp/block_spread.hpp"
#include "gl/program.hpp"
#include "gl/raster_pass.hpp"

namespace foresight {

/// Which node each triangle belongs to, and the room that each node takes. Immutable; for every context of the share
/// group.
class WarpScene {
 public:
  /// The first 254 nodes can be told apart; those after them do not move in warped pictures.
  explicit WarpScene(const SceneModel& scene);

  static constexpr std::size_t kMostNodes = 254;
  GLuint node_of_triangle() const { return node_of_triangle_.texture(); }  ///< R8UI: its index + 1
  /// Around each node's triangles, in its own frame, m; empty where it has none.
  const std::vector<Eigen::AlignedBox3d>& boxes() const { return boxes_; }

 private:
  gl::BufferTexture node_of_triangle_;
  std::vector<Eigen::AlignedBox3d> boxes_;
};

/// A view as it was drawn: what it shows, how far that is, and of which node. For every context of the share group.
struct WarpLayers {
  /// Throws std::invalid_argument: a lens with distortion, or a fish-eye.
  explicit WarpLayers(const Lens& lens, bool of_part = false);

  Lens lens;
  bool of_part;         ///< where no model is, nobody has looked: such as what lies behind the edges of another view
  gl::Texture picture;  ///< RGBA8 as PredictedView has it
  gl::Texture depth;    ///< R32F: 1 / z in 1/m at the pixel's centre, 0 where no model is
  gl::Texture node;     ///< R8UI: index + 1, 0 where no model is
  gl::Texture blocks;   ///< RGBA32F, of 8 x 8 px each: largest and smallest `depth`; 1 where surfaces part
  Pose T_world_camera = Pose::Identity();
  std::vector<Pose> T_world_node;
};

/// Takes what was drawn over into layers. Belongs to one context.
class LayerCapture {
 public:
  explicit LayerCapture(std::shared_ptr<const WarpScene> scene);

  /// `picture`, and one face with surfaces (gl::FaceImages), both of the size of the layers' lens.
  /// Throws std::invalid_argument where they are not.
  void operator()(const gl::Texture& picture, const gl::FaceImages& faces, const Pose& T_world_camera,
                  const SceneState& state, WarpLayers& layers) const;

  /// The layers' blocks, of their depth: of layers whose pixels somebody else has written.
  void find_blocks(const WarpLayers& layers) const;

  /// What `front` hides that a head's small motions may uncover: to be drawn from the same place through the same lens,
  /// into layers of a part. Valid until the next call.
  gl::ViewPart behind_edges(const WarpLayers& front);

 private:
  std::shared_ptr<const WarpScene> scene_;
  gl::Program capture_, blocks_;
  BlockSpread edges_;
};

}  // namespace foresight

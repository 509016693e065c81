// Draws lines of the world over a view, through the view's own lens; where the model hides them, dimmer and dotted.
#pragma once

#include <optional>

#include "common/lens.hpp"
#include "display/overlay_lines.hpp"
#include "display/view_target.hpp"
#include "gl/program.hpp"
#include "gl/raster_pass.hpp"

namespace foresight {

/// Belongs to one context.
class SceneOverlay {
 public:
  /// For views through `lens`, whose model is rasterised into faces of `faces_for(lens, 2)` (PredictedView).
  explicit SceneOverlay(const Lens& lens);

  /// From now on for views through this one.
  void set_lens(const Lens& lens) { lens_ = lens; }

  /// Over what is in `target`, which a view from `T_world_camera` fills. `faces`: of that view, with its depth. Each
  /// stroke has a dark rim, so that it is seen on any ground. Nothing outside of the target is touched.
  void draw(const OverlayLines& lines, const Pose& T_world_camera, const gl::FaceImages& faces,
            const ViewTarget& target);

 private:
  Lens lens_;
  gl::Program program_;
  gl::Buffer camera_;
  gl::BufferTexture strokes_;
  gl::VertexArray nothing_;
  gl::KeptFences fences_;
};

/// Where a point of the world is seen in such a target: px from the framebuffer's top left, whose height is `height`.
/// Nothing where the lens does not see it, or sees it outside of the target.
std::optional<Eigen::Vector2d> seen_at(const Eigen::Vector3d& p_world, const Lens& lens, const Pose& T_world_camera,
                                       const ViewTarget& target, int height);

}  // namespace foresight

// The scene as a stereogram, picture after picture: what the operator's window shows without a second eye's picture.
#pragma once

#include <memory>
#include <string>

#include "common/lens.hpp"
#include "display/stereogram/stereogram.hpp"
#include "gl/raster_pass.hpp"

namespace foresight {

/// What keys choose. A plain value.
struct StereogramLook {
  int depth = 1, pattern = 0, variant = 0;
  void next_depth() { depth = (depth + 1) % 3; }
  void next_pattern() { pattern = (pattern + 1) % 3; }
  void next_variant() { variant = (variant + 1) % 4; }
  /// For the window.
  std::string words() const;
};

/// Belongs to one context.
class LiveStereogram {
 public:
  /// `raster`: of the scene, depth alone.
  explicit LiveStereogram(gl::RasterPass raster) : raster_(std::move(raster)) {}

  /// As `camera` sees it, without its distortion, about width x height px. Each picture has other dots: what moved
  /// would drag shadows of itself along. How far and near the scene reaches is looked at now and then, which waits for
  /// the GPU, and followed slowly.
  void draw(const StereogramLook& look, const Pose& T_world_camera, const SceneState& state, const Lens& camera,
            int width, int height);
  /// Of the last draw().
  const gl::Texture& picture() const { return stereogram_->picture(); }

 private:
  void look_at_range(const Pose& T_world_camera, const SceneState& state, const Lens& lens);

  gl::RasterPass raster_;
  std::unique_ptr<gl::FaceImages> faces_, small_;
  std::unique_ptr<Stereogram> stereogram_;
  int pattern_ = -1;  // that stereogram_ has
  DepthRange range_;
  unsigned frame_ = 0;
};

}  // namespace foresight

// Finds the pixels whose surface is uncertain: the far side of depth discontinuities.
#pragma once

#include "gl/program.hpp"
#include "texture_gpu/camera_input.hpp"

namespace foresight {

/// From a camera's depth: its blocks, and its uncertain pixels (blocks.comp, uncertain.comp). One context.
class EdgePass {
 public:
  EdgePass();
  /// `margin_px` >= 0 in pixels of the faces, `depth_tolerance` in metres.
  void operator()(const CameraInput& camera, double margin_px, double depth_tolerance) const;

 private:
  gl::Program blocks_, uncertain_;
};

}  // namespace foresight

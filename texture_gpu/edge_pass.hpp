// Finds the pixels whose surface is uncertain: those beside depth discontinuities.
#pragma once

#include "gl/program.hpp"
#include "texture_gpu/camera_input.hpp"
#include "texture_gpu/work_list.hpp"

namespace foresight {

class FrameGate;

/// From a camera's depth: its blocks, the tiles that may hold edges, in these the near side of each
/// edge, and within the margin of that the uncertain pixels, which are marked (blocks.comp,
/// edge_tiles.comp, near_edges.comp, uncertain.comp). One context.
class EdgePass {
 public:
  EdgePass();
  /// CameraInput::marked_depth() is still as the faces' depth. `margin_px` >= 0 in pixels of the faces,
  /// `depth_tolerance` in metres. `gate`: in slices; may be null.
  void operator()(const CameraInput& camera, double margin_px, double depth_tolerance, FrameGate* gate = nullptr);

 private:
  gl::Program blocks_, edge_tiles_, near_edges_, uncertain_;
  WorkList tiles_, pixels_;
};

}  // namespace foresight

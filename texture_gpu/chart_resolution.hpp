// Which resolution a view asks of a chart.
#pragma once

#include <vector>

#include "gl/faces.hpp"
#include "texture_gpu/surface_patches.hpp"

namespace foresight {

/// A camera at one instant, as far as visibility and resolution are concerned.
struct AtlasView {
  const Lens* lens = nullptr;
  const gl::Faces* faces = nullptr;
  std::vector<Pose> T_camera_node;  ///< one per node of the scene
};

/// Texels per metre along u and v that give one texel per pixel on the chart as seen from the view;
/// zero: out of view, or a solid's chart seen from outside and behind.
Eigen::Vector2d density_in_view(const Chart& chart, const Patch& patch, const AtlasView& view);

}  // namespace foresight

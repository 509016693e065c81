// How large charts should be for the views that are expected.
#pragma once

#include <span>

#include "common/lens.hpp"
#include "scene/scene_model.hpp"

namespace foresight {

/// A camera pose and the scene at that instant.
struct ExpectedView {
  Pose T_world_camera;
  SceneState scene;
};

/// Side of a chart, metres, that spans about 256 pixels where the views come close to the surface:
/// a chart has one resolution, so it must be small against its distance; and not smaller, because
/// each chart has a border. Distance: the tenth percentile over all triangles in front of the views,
/// by area. For PatchOptions::chart_extent; 0 where no view sees any triangle.
double chart_extent_for(const SceneModel& scene, const Lens& lens, std::span<const ExpectedView> views);

}  // namespace foresight

// The predicted view, one pixel at a time in double precision: ray, triangle, chart, texels.
#pragma once

#include "tests/texture_gpu/reference/atlas_pixels.hpp"
#include "tests/texture_gpu/reference/ray_caster.hpp"
#include "texture_gpu/surface_patches.hpp"

namespace foresight::reference {

struct ViewPixel {
  Eigen::Vector4d rgba = Eigen::Vector4d::Zero();  ///< 0 .. 1, alpha as PredictedView::picture()
  bool borderline = false;  ///< another triangle, level or state may be right: too near to tell in float
};

class View {
 public:
  View(const SceneModel& scene, const SceneState& state, const SurfacePatches& surface, const Generation& generation,
       const AtlasPixels& pixels)
      : caster_(scene, state), state_(state), surface_(surface), generation_(generation), pixels_(pixels) {}

  ViewPixel at(const Lens& lens, const Pose& T_world_camera, const Eigen::Vector2d& pixel) const;

 private:
  ViewPixel shade(const RayCaster::Hit& hit, const Eigen::Vector3d& ray_in_world, double focal_px) const;
  Eigen::Vector4d coarse(const ChartCopy& chart, std::size_t index, const Eigen::Vector2d& texel) const;

  RayCaster caster_;
  const SceneState& state_;
  const SurfacePatches& surface_;
  const Generation& generation_;
  const AtlasPixels& pixels_;
};

}  // namespace foresight::reference

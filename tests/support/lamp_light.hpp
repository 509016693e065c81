// The light of a lamp in small scenes, ray by ray.
#pragma once

#include "scene/posed_frame.hpp"
#include "tests/texture_gpu/reference/ray_caster.hpp"
#include "texture_gpu/lamp/lamp.hpp"

namespace foresight {

/// Factor on red, green and blue of a surface with this normal, against what it has with all of the lamp hidden.
/// `rays`: to so many points of the lamp.
Eigen::Vector3d lamp_light(const Lamp& lamp, const reference::RayCaster& caster, const Eigen::Vector3d& p_world,
                           const Eigen::Vector3d& normal, int rays);

/// The photograph of a scene that is lit so; `light` scales it.
PosedImage lit_photograph(const SceneModel& scene, const SceneState& state, const Lens& lens,
                          const Pose& T_world_camera, const std::vector<Lamp>& lamps, double light, int rays = 16);

/// Of a triangle of the scene, counted through all nodes; world, either side.
Eigen::Vector3d normal_of(const SceneModel& scene, const SceneState& state, int triangle);

}  // namespace foresight

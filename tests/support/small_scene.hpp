// A scene small enough for brute force: a table, a solid box on it, a solid block that moves, and a
// tilted board behind them. Each has its own hue, so that a colour in the wrong place is found.
#pragma once

#include <map>
#include <opencv2/core.hpp>
#include <string>

#include "common/lens.hpp"
#include "scene/posed_frame.hpp"
#include "scene/scene_model.hpp"

namespace foresight {

enum SmallSceneNode { kTable, kBox, kBlock, kBoard };

std::shared_ptr<const SceneModel> small_scene();

/// True where a point of the table, the box or the block is closer than `reach` metres to another one of
/// them: there no depth tells them apart, and colours mix.
bool at_contact(const SceneState& state, int node, const Eigen::Vector3d& p_node, double reach);

/// A single rectangle of `x` by `y` metres in the plane z = 0 of the world.
std::shared_ptr<const SceneModel> plane_scene(double x, double y);

/// At rest, with node kBlock (where the scene has one) moved by `block_x` metres along x.
SceneState state_of(const SceneModel& scene, double block_x = 0);

/// Camera at `eye` that looks at `target`, its image upright (world z up).
Pose look_at(const Eigen::Vector3d& eye, const Eigen::Vector3d& target);

/// The view of the small scene that most tests take.
Pose usual_view();

/// 160 x 120 px lenses by name: pinhole, plumb_bob, rational, fisheye (104 degrees), wide_fisheye
/// (208 degrees, six cube faces).
Lens small_lens(const std::string& kind);
inline const char* const kLensKinds[] = {"pinhole", "plumb_bob", "rational", "fisheye", "wide_fisheye"};

/// True colour (BGR, 0..1) of the surface at a point of a node: smooth waves of 0.2 m around the node's hue.
Eigen::Vector3d paint(int node, const Eigen::Vector3d& p_node);

/// What a camera sees of the painted scene, ray by ray; black where there is no model. `gain`
/// multiplies the 8-bit values.
cv::Mat photograph(const SceneModel& scene, const SceneState& state, const Lens& lens, const Pose& T_world_camera,
                   double gain = 1);

PosedImage posed_photograph(const SceneModel& scene, const SceneState& state, const Lens& lens,
                            const Pose& T_world_camera, double gain = 1);

}  // namespace foresight

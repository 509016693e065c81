// Heads and eyes as numbers: what a runtime says of them, checked, as poses and lenses of ours.
//
// Space is that of input/tracker.hpp: x forward, y left, z up. A head and an eye look along their x.
#pragma once

#include <optional>

#include "common/lens.hpp"
#include "scene/scene_model.hpp"

namespace foresight::head {

/// What an eye sees, rad from straight ahead: left and down are negative.
struct EyeFov {
  double left = 0, right = 0, up = 0, down = 0;
};

struct EyeView {
  Pose T_space_eye = Pose::Identity();
  EyeFov fov;
};

/// A runtime's pose (axes of input/room_axes.hpp) in our axes; nothing where a number is none or beyond any room
/// (100 m), or the quaternion has not unit length to 1 %.
std::optional<Pose> checked_pose(const Eigen::Vector3d& p_room, const Eigen::Quaterniond& q_room);

/// Nothing where it is no view: a number is none, sides are the wrong way round, narrower than 1 degree, or beyond
/// 89 degrees from straight ahead.
std::optional<EyeFov> checked_fov(const EyeFov& fov);

/// The pinhole that shows exactly `fov` in so many px. `fov` is a checked one.
Lens eye_lens(const EyeFov& fov, int width, int height);

/// All that a lens sees, such as that of a head display's panel, up to 85 degrees from straight ahead. Throws
/// std::invalid_argument: nothing.
EyeFov fov_of(const Lens& lens);

/// The same field of view, wider by `guard` rad on each side, up to 85 degrees from straight ahead.
EyeFov widened(const EyeFov& fov, double guard);

/// They show the same, to 0.05 px at the middle and 1 in 1,000 of the scale; distortions are equal.
bool alike(const Lens& a, const Lens& b);

/// No side differs by more than `tolerance` rad.
bool alike(const EyeFov& a, const EyeFov& b, double tolerance = 1e-3);

/// From a body that looks along x to the camera (optical frame) that sees what it sees.
Pose T_body_camera();

/// The same place, turned about the vertical alone: forward is where the body looks. Of one that looks straight down,
/// its top is forward; straight up, its bottom.
Pose levelled(const Pose& T_space_body);

/// Where the operator's space lies in the world, if the head is to be where the camera is and to look where it looks;
/// up stays up: both are levelled().
Pose T_world_space_for(const Pose& T_world_camera, const Pose& T_space_head);

}  // namespace foresight::head

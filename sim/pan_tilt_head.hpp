// The stereo head of the live lab: two cameras on a pan-tilt unit in front of the table.
//
//   side view                          top view
//        tilt axis (y, to the left)         left camera   o--> z forward
//   pan axis | +--[camera]--> x forward     pan axis    (+)----> x
//      (z)   | |                            right camera  o-->
//            +-+   pan > 0 turns left, tilt > 0 looks down (right-hand rule about z and y)
//
// Bodies: x forward, y left, z up; cameras: x right, y down, z forward. Metres and radians.
#pragma once

#include "scene/scene_model.hpp"

namespace foresight::sim {

struct PanTilt {
  double pan = 0;   ///< rad
  double tilt = 0;  ///< rad
};

inline constexpr double kStereoBaseline = 0.065;  ///< metres between the cameras' centres

/// Where the head's foot stands: pan = tilt = 0 looks straight ahead, at the wall.
Pose T_world_head_foot();
/// Of the left camera, by the shafts' positions.
Pose T_world_head_left(const PanTilt& shafts);
/// The right camera in the left one's frame: the baseline along x, nothing else.
Pose T_head_left_right();

/// Shafts with which the head looks at the middle of the table.
inline constexpr PanTilt kHeadAtTable{0.0, 0.62};

}  // namespace foresight::sim

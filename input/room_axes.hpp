// The axes of WebXR and OpenXR: x right, y up, z backwards, of the room and of each device in it alike.
#pragma once

#include "scene/scene_model.hpp"

namespace foresight {

/// The same pose in the axes of Tracker: x forward, y left, z up, of the room and of the device.
inline Pose from_room_axes(const Pose& T_xr) {
  Eigen::Matrix3d R;
  R << 0, 0, -1, -1, 0, 0, 0, 1, 0;
  Pose out = Pose::Identity();
  out.translation() = R * T_xr.translation();
  out.linear() = R * T_xr.linear() * R.transpose();
  return out;
}
/// And back.
inline Pose to_room_axes(const Pose& T) {
  Eigen::Matrix3d R;
  R << 0, -1, 0, 0, 0, 1, -1, 0, 0;
  Pose out = Pose::Identity();
  out.translation() = R * T.translation();
  out.linear() = R * T.linear() * R.transpose();
  return out;
}

}  // namespace foresight

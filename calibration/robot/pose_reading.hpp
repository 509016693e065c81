// Robot poses that were meant otherwise than they are read: what fits the images instead, by name.
#pragma once

#include "calibration/robot/hand_eye_start.hpp"

namespace foresight {

/// Throws InputError where the poses contradict the images as they are read, and another reading has less than a
/// quarter of `start`'s misfit: the other mount (or poses from flange to base, which look the same), quaternions with w
/// first, transposed rotations, mirrored pictures, a board of another size; and where the robot moved some hundred
/// times as far as the images show (millimetres), or as little. `forced`: the user named the mount; otherwise both were
/// tried.
void require_meant(const HandEyeStart& start, bool forced, std::span<const RobotPose> poses,
                   std::span<const Pose> T_camera_board, std::span<const Pose> symmetries);

}  // namespace foresight

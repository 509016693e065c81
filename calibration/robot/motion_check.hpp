// Which motions a hand-eye calibration lacks.
#pragma once

#include <span>
#include <string>

#include "scene/scene_model.hpp"

namespace foresight {

struct MotionSpread {
  double largest_turn_rad = 0;                           ///< between any two poses
  double second_axis_rad = 0;                            ///< RMS turn about the best second axis; small: one axis only
  Eigen::Vector3d main_axis = Eigen::Vector3d::UnitX();  ///< in the frame of the poses' own body
};

MotionSpread motion_spread(std::span<const Pose> poses);

/// Throws InputError at `where` that names the missing motion, where the poses do not turn, or
/// turn about one axis only: what stays open then is said with it. `body`: what turns ("wrist").
void require_two_axes(const MotionSpread& spread, const std::string& where, const std::string& body);

}  // namespace foresight

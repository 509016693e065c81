// The residual of one corner, for Ceres.
#pragma once

#include <ceres/cost_function.h>

#include "calibration/camera/lens_projection.hpp"

namespace foresight {

struct CornerResidual {
  Distortion distortion = Distortion::radtan4;
  Eigen::Vector3d p_board;  ///< flat
  Eigen::Vector2d warp;     ///< warp_weights() of the point
  Eigen::Vector2d pixel;    ///< measured
  double weight = 1;        ///< one over the standard deviation
  bool right = false;
};

/// Two residuals, weight * (predicted - pixel). Parameters: lens (16), T_left_board (7, see
/// rigid_motion.hpp), board warp (2), and for the right camera T_left_right (7). The caller owns it.
ceres::CostFunction* corner_cost(const CornerResidual& residual);

}  // namespace foresight

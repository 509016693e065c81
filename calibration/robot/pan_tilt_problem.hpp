// Least squares behind a pan-tilt calibration.
#pragma once

#include "calibration/camera/rigid_motion.hpp"
#include "calibration/robot/pan_tilt.hpp"

namespace foresight {

struct PanTiltState {
  MotionParameters world{0, 0, 0, 1, 0, 0, 0};        ///< T_world_pan
  std::array<double, 2> link{0, 1.5707963267948966};  ///< length, twist
  MotionParameters camera{0, 0, 0, 1, 0, 0, 0};       ///< T_tilt_camera
  std::array<double, 4> joints{1, 1, 0, 0};           ///< gains, backlashes
  std::vector<int> held_joints{0, 1, 2, 3};           ///< entries of `joints` that are not estimated
  double sigma_rad = 1, sigma_m = 1;
  bool robust = false;
};

PanTiltModel to_model(const PanTiltState& state);

/// Orientation and place from nothing: rotations from a grid of starts, then everything. Returns
/// the cost per sample (rad^2 + m^2).
double start_pan_tilt(const std::vector<PanTiltSample>& samples, PanTiltState& state);

/// Minimises from `state`; sample `left_out` does not count. Throws RuntimeFailure.
double fit_pan_tilt(const std::vector<PanTiltSample>& samples, PanTiltState& state, int left_out = -1,
                    bool turns_only = false);

/// Covariance of the estimated parameters (world 6, link 2, camera 6, joints) in the order of
/// their tangents; `open` counts directions that no pose determines.
Eigen::MatrixXd pan_tilt_covariance(const std::vector<PanTiltSample>& samples, PanTiltState& state, int& open);

}  // namespace foresight

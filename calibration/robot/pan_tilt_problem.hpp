// Least squares behind a pan-tilt calibration.
#pragma once

#include <ceres/problem.h>

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
PanTiltState to_state(const PanTiltModel& model);

/// The camera at shafts `pan` and `tilt`, by the blocks of a PanTiltState.
template <typename T>
struct HeadMotion {
  Eigen::Quaternion<T> q;  ///< T_world_camera
  Eigen::Matrix<T, 3, 1> p;
};

template <typename T>
Eigen::Quaternion<T> turn_about(const Eigen::Vector3d& axis, const T& angle) {
  using std::cos;
  using std::sin;
  const T s = sin(angle / T(2));
  return {cos(angle / T(2)), s * axis.x(), s * axis.y(), s * axis.z()};
}

template <typename T>
HeadMotion<T> head_motion(const T* world, const T* link, const T* camera, const T& pan, const T& tilt) {
  using Vector = Eigen::Matrix<T, 3, 1>;
  using Quaternion = Eigen::Quaternion<T>;
  const Quaternion q_pan = Eigen::Map<const Quaternion>(world) * turn_about(Eigen::Vector3d::UnitZ(), pan);
  const Quaternion q_tilt =
      q_pan * (turn_about(Eigen::Vector3d::UnitX(), link[1]) * turn_about(Eigen::Vector3d::UnitZ(), tilt));
  const Vector along(link[0], T(0), T(0));
  const Vector p =
      Eigen::Map<const Vector>(world + 4) + q_pan * along + q_tilt * Vector(Eigen::Map<const Vector>(camera + 4));
  return {q_tilt * Eigen::Map<const Quaternion>(camera), p};
}

/// Manifolds of the state's blocks; joints that are held stay constant. The blocks are in `problem` already.
void hold_joints(PanTiltState& state, ceres::Problem& problem);

/// Sets held_joints: gains where they are wanted, backlashes where a joint came from both sides. Notes say which
/// backlash stays open.
void choose_joints(const std::vector<PanTiltAngles>& angles, bool gains, bool backlash, PanTiltState& state,
                   std::vector<std::string>& notes);

/// Names of the estimated parameters, unit as suffix: world 6, link 2, camera 6, joints.
std::vector<std::string> pan_tilt_names(const PanTiltState& state);

/// Throws InputError where a joint did not move, or only with the other one, naming what stays open.
void require_sweeps(const std::vector<PanTiltAngles>& angles);

/// Factors from the manifolds' tangents, in which a rotation steps by half angles, to radians.
Eigen::VectorXd pan_tilt_tangent_scale(Eigen::Index size);

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

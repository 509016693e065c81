// The bundle adjustment behind a hand-eye calibration, over a choice of views.
#pragma once

#include "calibration/camera/rigid_motion.hpp"
#include "calibration/robot/hand_eye.hpp"

namespace foresight {

/// What is estimated, and the noise that weighs it.
struct HandEyeState {
  CameraMount mount = CameraMount::fixed;
  CameraModel camera;
  bool camera_held = false;
  MotionParameters X{0, 0, 0, 1, 0, 0, 0};
  MotionParameters Y{0, 0, 0, 1, 0, 0, 0};
  double board_scale = 1;                          ///< true over stated size of the board
  double board_sigma = 0.01;                       ///< of board_scale before the images; 0 holds it
  std::vector<std::array<double, 6>> corrections;  ///< one per view, zero for views left out
  /// Weight of each robot pose, 1 on average; empty: all alike. With `robot_freedom` the noise of robot poses is taken
  /// as Student's t of so many degrees, and a pose that is far off counts less; 0: normal.
  std::vector<double> trust;
  double robot_freedom = 0;
  std::vector<double> joint_offsets;
  std::vector<double> joint_means;  ///< where the offsets are before the images, to joint_sigma
  double joint_sigma = 0.05;
  double sigma_px = 0.3;
  double sigma_rad = 1e-3;
  double sigma_m = 1e-3;
};

struct HandEyeCovariance {
  Vector6d X_sigma, Y_sigma;
  LensParameters lens_sigma{};
  double board_scale_sigma = 0;
  std::vector<double> joint_offset_sigma;
  std::vector<Eigen::MatrixXd> corrections;  ///< per view that is used
  int open = 0;                              ///< directions of the shared parameters that no residual sees
};

/// Weights: `used[i]` says whether view i counts; `keep[i][j]` whether its corner j does.
struct HandEyeSelection {
  std::vector<bool> used;
  std::vector<std::vector<bool>> keep;
};

/// Minimises over the selected views and re-estimates the three noises `noise_rounds` times from
/// the residuals and their redundancy (Helmert). Throws RuntimeFailure where it does not converge.
void adjust(const HandEyeData& data, const HandEyeSelection& selection, int noise_rounds, HandEyeState& state,
            HandEyeCovariance* covariance = nullptr);

/// A point of the board in its true size.
Eigen::Vector3d scaled_point(const HandEyeState& state, const Eigen::Vector3d& p_board);

/// Pixel that `state` predicts, for a robot pose moved by `correction`; far outside where it lies behind the camera.
Eigen::Vector2d predicted_pixel(const HandEyeState& state, const RobotPose& robot, const Vector6d& correction,
                                const Eigen::Vector3d& p_board);

/// Correction that the joint offsets alone make to a robot pose.
Vector6d joint_correction(const HandEyeState& state, const RobotPose& robot);

}  // namespace foresight

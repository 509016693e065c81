// Hand-eye calibration: where the camera sits on the arm, or where the arm stands before the camera.
//
//   camera moves with the arm                      camera stands fixed, the arm carries the board
//   base --F_i--> flange --X--> camera             base --F_i--> flange --Y--> board
//   base --Y----> board                            base --X----> camera
//
//   predicted corner   p_camera = X^-1 F_i^-1 Y p_board      or      X^-1 F_i Y p_board
//
// Solved as one bundle adjustment over X, Y, the lens (unless it is given) and a small correction
// of each robot pose; see docs/calibration/robot.md for residuals, gauge and loss.
#pragma once

#include <optional>

#include "calibration/camera/camera_model.hpp"
#include "calibration/result/verdict.hpp"
#include "calibration/robot/rigid_math.hpp"
#include "calibration/target/corner_set.hpp"

namespace foresight {

enum class CameraMount { fixed, moving };
std::string to_string(CameraMount mount);

/// Pose of the flange as the robot reports it, and how it changes with the joints.
struct RobotPose {
  Pose T_base_flange = Pose::Identity();
  /// 6 x joints: step_between() of the flange pose per radian (or metre) of each joint; empty: no
  /// joint offsets are estimated.
  Eigen::MatrixXd flange_per_joint;
};

struct HandEyeData {
  CornerSet corners;
  std::vector<RobotPose> poses;       ///< one per view, in the order of corners.views
  int cols = 0, rows = 0;             ///< of points, where the board looks the same when turned; 0: it does not
  std::vector<double> joint_offsets;  ///< rad or m: those that the poses have in them already; empty: none
};

struct HandEyeOptions {
  std::optional<CameraMount> mount;             ///< empty: both are tried
  std::optional<CameraModel> camera;            ///< given: the lens is held
  Distortion distortion = Distortion::radtan4;  ///< of a lens that is estimated
  double board_sigma = 0.01;                    ///< doubt about the board's stated size, relative; 0: it is exact
  double joint_sigma = 0.05;  ///< doubt about a joint's zero, rad or m; offsets that no view tells stay 0
  bool score = true;          ///< leave-one-view-out, one solve per view
  double reject_sigmas = 5;   ///< corners beyond this many robust sigmas are left out
};

/// What a view contributed, and what it says when it is left out.
struct HandEyeView {
  std::string name;
  bool used = true;          ///< false: its robot pose contradicts the others
  int points = 0;            ///< corners used
  int rejected = 0;          ///< corners left out
  double rms_px = 0;         ///< of the used corners, after the solve
  Vector6d correction;       ///< of the robot pose: rad, m, in the flange frame
  double trust = 1;          ///< weight of the robot pose; below 1 where the noise has a heavy tail and it lies there
  double loo_px = 0;         ///< RMS per corner of prediction minus found, solved without this view
  double loo_mm = 0;         ///< RMS over corners of board points by the robot minus by PnP, without this view
  double loo_across_mm = 0;  ///< the part of it across the line of sight
  int turned = 0;            ///< quarter turns by which the board's corner order was corrected
  std::vector<Eigen::Vector2d> found_px, residuals_px;  ///< of all corners: where, and found less predicted
};

struct HandEyeSummary {
  CameraMount mount = CameraMount::fixed;
  double start_mm_fixed = 0, start_mm_moving = 0;  ///< closed-form misfit of both mounts; 0: not tried
  CameraModel camera;
  bool camera_given = false;
  Pose X = Pose::Identity();  ///< T_base_camera (fixed) or T_flange_camera (moving)
  Pose Y = Pose::Identity();  ///< T_flange_board (fixed) or T_base_board (moving)
  Vector6d X_sigma, Y_sigma;  ///< turn (rad) about and shift (m) along the axes of the parent frame
  double board_scale = 1;     ///< true over stated size of the board, by the robot's measure
  double board_scale_sigma = 0;
  LensParameters lens_sigma{};
  std::vector<double> joint_offsets, joint_offset_sigma;  ///< rad or m; see RobotPose
  double sigma_px = 0;                                    ///< noise of a corner's coordinate
  double sigma_robot_rad = 0, sigma_robot_m = 0;          ///< noise of a robot pose, per axis
  double in_sample_px = 0;                                ///< RMS per corner with corrected robot poses
  double uncorrected_px = 0;                              ///< RMS per corner without the corrections
  double loo_px = 0, loo_mm = 0, loo_across_mm = 0;
  int rejected_points = 0;
  std::vector<HandEyeView> views;
  std::vector<std::string> notes;  ///< warnings in words
  Verdict verdict;
};

/// A hand-eye as a result file keeps it.
struct KnownHandEye {
  CameraMount mount = CameraMount::fixed;
  CameraModel camera;
  Pose X = Pose::Identity(), Y = Pose::Identity();  ///< as HandEyeSummary has them
  double board_scale = 1;
};

/// How well a hand-eye predicts views that its solver has not seen.
struct HandEyeScore {
  double px = 0;  ///< RMS per corner, by the robot alone
  double mm = 0;  ///< RMS over corners, robot against image
  int views = 0;
  double worst_px = 0;  ///< of a view
  std::string worst;    ///< its name
};

/// `data.poses`: with the joints' offsets in them. A board that looks the same when turned is taken in the order in
/// which it fits best.
HandEyeScore score_hand_eye(const KnownHandEye& known, const HandEyeData& data);

/// Throws InputError: fewer than 5 views or poses of another count, motion that leaves X or Y open
/// (naming it), views that no hand-eye fits.
HandEyeSummary solve_hand_eye(const HandEyeData& data, const HandEyeOptions& options);

}  // namespace foresight

// A first hand-eye: lens and board poses from the images alone, then Park's closed form.
//
// F. Park, B. Martin: Robot sensor calibration: solving AX = XB on the Euclidean group. IEEE
// Transactions on Robotics and Automation 10, 1994; OpenCV's implementation.
#pragma once

#include "calibration/robot/hand_eye.hpp"

namespace foresight {

/// Lens from the views by OpenCV's calibrateCamera (radial and tangential of `distortion`, at most
/// plumb_bob). Throws InputError where the views do not determine it.
CameraModel first_lens(const CornerSet& corners, Distortion distortion);

struct BoardFit {
  Pose T_camera_board = Pose::Identity();
  double rms_px = 0;
};

/// Pose of the board in one view. Throws InputError naming the view where there is none.
BoardFit board_pose(const CameraModel& camera, const std::vector<Eigen::Vector3d>& p_board, const BoardView& view);

struct HandEyeStart {
  CameraMount mount = CameraMount::fixed;
  Pose X = Pose::Identity();
  Pose Y = Pose::Identity();
  double misfit_m = 0;            ///< median distance of the board's origin, robot against image
  std::vector<int> turned;        ///< quarter turns of the corner order, per view
  std::vector<double> misfits_m;  ///< per view
};

/// Closed form of one mount from the board poses of all views; `symmetries`: poses of the board
/// in itself under which it looks the same, the first the identity.
HandEyeStart start_hand_eye(CameraMount mount, std::span<const RobotPose> poses, std::span<const Pose> T_camera_board,
                            std::span<const Pose> symmetries);

/// T_camera_board that the robot predicts.
Pose predicted_board(CameraMount mount, const Pose& T_base_flange, const Pose& X, const Pose& Y);

/// Poses in itself of a grid of cols x rows points, and the corner order that each of them means:
/// point i of the grid as seen lies at point order[i] of the turned one.
struct BoardTurn {
  int quarter_turns = 0;
  Pose T_board_turned = Pose::Identity();
  std::vector<int> order;
};
std::vector<BoardTurn> board_turns(const std::vector<Eigen::Vector3d>& p_board, int cols, int rows);

}  // namespace foresight

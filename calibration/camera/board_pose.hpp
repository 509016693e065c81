// Where the board stands, seen by cameras that are known.
#pragma once

#include "calibration/camera/rig.hpp"

namespace foresight {

struct BoardPose {
  Pose T_left_board = Pose::Identity();
  double sum_of_squares = 0;  ///< px^2 of all corners that were used, not weighted
  int corners = 0;
};

/// Least squares over the corners of `view` in the cameras `first` to `last`, equally weighted, from
/// `start`; `p_board` as warped. Nothing where the board gets behind a camera.
std::optional<BoardPose> refine_board_pose(const CameraRig& rig, const std::vector<Eigen::Vector3d>& p_board,
                                           const RigView& view, int first, int last, const Pose& start);

/// The same from a start of its own, found with camera `first`: from the plane's homography, which
/// has two solutions (Collins and Bartoli 2014, in OpenCV); the better one after refinement.
/// Nothing where fewer than four rays lie in front of the camera.
std::optional<BoardPose> find_board_pose(const CameraRig& rig, const std::vector<Eigen::Vector3d>& p_board,
                                         const RigView& view, int first, int last);

/// T_left_board in camera coordinates of `camera` as if it were alone.
inline CameraRig alone(const CameraRig& rig, int camera) {
  return {{{rig.cameras[static_cast<std::size_t>(camera)]}, Pose::Identity()}, rig.warp};
}

}  // namespace foresight

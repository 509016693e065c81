// Cameras in calibration result files.
//
//   result of kind "intrinsics"      model: radtan4            size: [width, height], px
//                                    focal_px: [fx, fy]        centre_px: [cx, cy]
//                                    distortion: [k1, ...]     as many as the model has, in its order
//   result of kind "stereo"          left: {...}               each as above
//                                    right: {...}
//                                    T_left_right: {xyz: [..], quaternion: [x, y, z, w]}
//   both, where the board's warp was estimated:
//     board: {points: 54, extent_m: [0.2, 0.125], warp_m: [0.0004, -0.0001]}     as KnownBoard
//
// Numbers read back exactly as they were, but for the rotation, which reading normalises.
#pragma once

#include "calibration/camera/rig.hpp"

namespace YAML {
class Node;
}

namespace foresight {

class YamlMap;

/// The board that a camera was calibrated with, as far as another session can know it again.
struct KnownBoard {
  int points = 0;
  Eigen::Vector2d extent_m = Eigen::Vector2d::Zero();  ///< between the outermost points, along x and y
  BoardWarp warp;

  KnownBoard() = default;
  KnownBoard(const std::vector<Eigen::Vector3d>& p_board, const BoardWarp& warp);

  /// Whether `p_board` has as many points and the same extent: the same board, or another print of it.
  bool is_laid_out_as(const std::vector<Eigen::Vector3d>& p_board) const;
};

YAML::Node to_yaml(const KnownBoard& board);
YAML::Node to_yaml(const CameraModel& camera);
YAML::Node to_yaml(const CalibratedCameras& cameras);  ///< as "intrinsics" or "stereo", by their number

/// {xyz: [..], quaternion: [x, y, z, w]}, the form that YamlMap::pose reads.
YAML::Node to_yaml(const Pose& pose);

/// Throws InputError naming file, line and field: unknown or missing keys, a number of
/// coefficients that is not the model's, sizes or focal lengths that are not positive.
CameraModel read_camera(const YamlMap& yaml);
CalibratedCameras read_calibrated_cameras(const YamlMap& result);  ///< of kind "intrinsics" or "stereo"

/// Of the result's `board`; nothing where it has none.
std::optional<KnownBoard> read_known_board(const YamlMap& result);

}  // namespace foresight

// A pair as if its cameras looked the same way, side by side: what programs that match rows of two images want.
#pragma once

#include <Eigen/Core>

#include "calibration/camera/camera_model.hpp"

namespace foresight {

/// Bouguet's rectification, as OpenCV's stereoRectify and ROS name its parts.
///
///   ray in the rectified camera = R * ray in the camera          pixel = P * (point in the left rectified camera, 1)
///
/// Both P have one focal length and one centre; the right one's P(0, 3) is -fx times the baseline, metres and px.
struct Rectification {
  Eigen::Matrix3d R_left, R_right;
  Eigen::Matrix<double, 3, 4> P_left, P_right;
  Eigen::Matrix4d Q;  ///< (u, v, disparity, 1) to a point in the left rectified camera
};

/// Whether both cameras are perspective or both fish-eyes, and their images of one size.
bool can_be_rectified(const CalibratedCameras& pair);

/// The rectified images have the cameras' size, and no pixel that the cameras did not see (of a perspective lens).
/// `pair`: one that can be rectified.
Rectification rectify(const CalibratedCameras& pair);

}  // namespace foresight

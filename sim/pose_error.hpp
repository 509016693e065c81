// Camera poses that are a little wrong, by a known number of pixels.
#pragma once

#include <opencv2/core.hpp>

#include "common/lens.hpp"
#include "scene/scene_model.hpp"

namespace foresight::sim {

/// Root mean square, over the pixels with a depth, of how far the surface point of each moves in
/// the image when the camera is taken to stand at T_world_camera * `error`. `depth`: CV_32FC1, metres
/// along the optical axis at the pixels' centres, 0 where nothing is. Points that leave the lens's
/// view do not count. Zero where no pixel has a depth.
double displacement_px(const Lens& lens, const cv::Mat& depth, const Pose& error);

/// A random small motion of the camera, T_camera_wrong, whose displacement_px is `px` to 1e-6 of
/// it. Rotation and translation have like effects at the mean depth. The same for the same
/// `seed` and `number`. Identity where no pixel has a depth or `px` is 0. `persistence`, 0 .. below 1:
/// correlation of its direction with that of the number before.
Pose random_pose_error(const Lens& lens, const cv::Mat& depth, double px, unsigned seed, int number,
                       double persistence = 0);

}  // namespace foresight::sim

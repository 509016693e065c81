#pragma once

#include "common/lens.hpp"
#include "scene/scene_model.hpp"

namespace foresight {

/// What the program looks through where there are two cameras: their lenses, and where one stands in the other's frame.
/// calibration/camera/camera_model.hpp has a calibration as solvers and files have it, of any lens model.
struct StereoLenses {
  Lens left, right;
  Pose T_left_right = Pose::Identity();  ///< right camera to left camera coordinates
};

}  // namespace foresight

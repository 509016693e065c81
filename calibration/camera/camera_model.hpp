// A calibrated camera and a calibrated pair, as the solvers deliver them and files keep them.
#pragma once

#include "calibration/camera/lens_projection.hpp"
#include "common/lens.hpp"
#include "scene/scene_model.hpp"

namespace foresight {

struct CameraModel {
  int width = 0;   ///< px
  int height = 0;  ///< px
  Distortion distortion = Distortion::radtan4;
  LensParameters lens{};
};

struct StereoModel {
  CameraModel left;
  CameraModel right;
  Pose T_left_right = Pose::Identity();  ///< right camera to left camera coordinates
};

/// The lens that the rest of the program draws with. Throws InputError for thin_prism, which it
/// does not know: use another model.
Lens to_lens(const CameraModel& camera);

/// plumb_bob becomes radtan4 where k3 is zero, else radtan5.
CameraModel to_camera_model(const Lens& lens);

}  // namespace foresight

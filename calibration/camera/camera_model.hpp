// A calibrated camera and a calibrated pair, of any lens model, as the solvers deliver them and files keep them.
#pragma once

#include <vector>

#include "calibration/camera/lens_projection.hpp"
#include "scene/stereo_lenses.hpp"

namespace foresight {

struct CameraModel {
  int width = 0;   ///< px
  int height = 0;  ///< px
  Distortion distortion = Distortion::radtan4;
  LensParameters lens{};
};

/// One camera, or a pair.
struct CalibratedCameras {
  std::vector<CameraModel> cameras;      ///< the only one, or left and right
  Pose T_left_right = Pose::Identity();  ///< right camera to left camera coordinates

  bool pair() const { return cameras.size() > 1; }
  const CameraModel& left() const { return cameras.front(); }  ///< or the only one
  const CameraModel& right() const { return cameras.at(1); }
};

/// The lens that the rest of the program draws with. Throws InputError for thin_prism, which it
/// does not know: use another model.
Lens to_lens(const CameraModel& camera);

/// Both lenses of a pair, or the only one twice. Throws as to_lens().
StereoLenses to_lenses(const CalibratedCameras& cameras);

/// plumb_bob becomes radtan4 where k3 is zero, else radtan5.
CameraModel to_camera_model(const Lens& lens);

}  // namespace foresight

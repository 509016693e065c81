#include "calibration/camera/camera_model.hpp"

#include <algorithm>

#include "common/error.hpp"

namespace foresight {
namespace {

LensModel lens_model(const CameraModel& camera) {
  switch (camera.distortion) {
    case Distortion::radtan4:
    case Distortion::radtan5: return LensModel::plumb_bob;
    case Distortion::rational: return LensModel::rational_polynomial;
    case Distortion::equidistant: return LensModel::equidistant;
    case Distortion::thin_prism: break;
  }
  throw InputError("lens model thin-prism", "the display cannot draw with it", "calibrate with --model rational");
}

}  // namespace

Lens to_lens(const CameraModel& camera) {
  Lens::Parameters p;
  p.model = lens_model(camera);
  p.width = camera.width;
  p.height = camera.height;
  const LensParameters& l = camera.lens;
  p.fx = l[0], p.fy = l[1], p.cx = l[2], p.cy = l[3];
  std::copy_n(l.begin() + 4, p.d.size(), p.d.begin());
  return Lens(p);
}

StereoLenses to_lenses(const CalibratedCameras& cameras) {
  return {to_lens(cameras.left()), to_lens(cameras.cameras.back()), cameras.T_left_right};
}

CameraModel to_camera_model(const Lens& lens) {
  const Lens::Parameters& p = lens.parameters();
  CameraModel camera{p.width, p.height, Distortion::radtan4, {p.fx, p.fy, p.cx, p.cy}};
  std::copy(p.d.begin(), p.d.end(), camera.lens.begin() + 4);
  if (p.model == LensModel::equidistant) camera.distortion = Distortion::equidistant;
  if (p.model == LensModel::rational_polynomial) camera.distortion = Distortion::rational;
  if (p.model == LensModel::plumb_bob && p.d[4] != 0) camera.distortion = Distortion::radtan5;
  return camera;
}

}  // namespace foresight

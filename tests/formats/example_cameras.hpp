// Cameras of every model, as real ones are: no round numbers.
#pragma once

#include <Eigen/Geometry>

#include "calibration/formats/camera_formats.hpp"

namespace foresight {

inline CameraModel example_camera(Distortion model) {
  CameraModel camera{640, 480, model, {533.0123456789, 534.9876543211, 341.1, 235.3 + 1e-13}};
  const std::array<double, 12> d{-0.28110312, 0.1 / 3, 1.2e-3, -2.0 / 7e3, 0.0123, 0.021,
                                 -0.0031,     7e-4,    1e-4,   -3e-5,      2e-4,   5e-6};
  for (const int i : free_parameters(model))
    if (i >= 4) camera.lens[static_cast<std::size_t>(i)] = d[static_cast<std::size_t>(i - 4)];
  return camera;
}

inline CalibratedCameras example_pair(Distortion model) {
  CalibratedCameras pair{{example_camera(model), example_camera(model)}, Pose::Identity()};
  for (std::size_t i = 0; i < 5; ++i) pair.cameras[1].lens[i] *= 1.003;
  pair.T_left_right.linear() = Eigen::AngleAxisd(0.031, Eigen::Vector3d(0.2, 1, -0.3).normalized()).toRotationMatrix();
  pair.T_left_right.translation() = Eigen::Vector3d(0.0731 / 3, -1e-3, 4e-4);
  return pair;
}

}  // namespace foresight

// Cameras in calibration result files.
//
//   result of kind "intrinsics"      model: radtan4            size: [width, height], px
//                                    focal_px: [fx, fy]        centre_px: [cx, cy]
//                                    distortion: [k1, ...]     as many as the model has, in its order
//   result of kind "stereo"          left: {...}               each as above
//                                    right: {...}
//                                    T_left_right: {xyz: [..], quaternion: [x, y, z, w]}
//
// Numbers read back exactly as they were, but for the rotation, which reading normalises.
#pragma once

#include <yaml-cpp/yaml.h>

#include "calibration/camera/camera_model.hpp"
#include "scene/yaml_fields.hpp"

namespace foresight {

YAML::Node to_yaml(const CameraModel& camera);
YAML::Node to_yaml(const StereoModel& stereo);

/// {xyz: [..], quaternion: [x, y, z, w]}, the form that YamlMap::pose reads.
YAML::Node to_yaml(const Pose& pose);

/// Throws InputError naming file, line and field: unknown or missing keys, a number of
/// coefficients that is not the model's, sizes or focal lengths that are not positive.
CameraModel read_camera(const YamlMap& yaml);
StereoModel read_stereo(const YamlMap& yaml);

}  // namespace foresight

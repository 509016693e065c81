// Reads and writes camera.yaml: a ROS camera_info file (sensor_msgs/CameraInfo as camera_calibration writes it).
#pragma once

#include <filesystem>
#include <optional>

#include "common/lens.hpp"
#include "scene/scene_model.hpp"

namespace foresight {

struct CameraInfo {
  Lens lens;
  std::optional<Pose> T_left_right;  ///< only in the file of a second camera
};

/// Keys: image_width, image_height, camera_matrix, distortion_model, distortion_coefficients.
/// plumb_bob takes 4 or 5 coefficients, rational_polynomial 8, equidistant 4; other lengths are
/// taken where the difference is zeros only. The other keys of camera_info (camera_name,
/// rectification_matrix, projection_matrix, binning_x, binning_y, roi) change nothing for raw
/// images and are ignored, but a binning or region of interest that would change the image is
/// refused. Throws InputError naming file, line and field.
CameraInfo read_camera_info(const std::filesystem::path& file);

/// The text of such a file: read_camera_info() gives back the same lens, to the last bit, and the same T_left_right.
std::string camera_info_text(const CameraInfo& camera, const std::string& name);

}  // namespace foresight

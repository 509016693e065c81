// Lenses in files, whatever wrote them.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "calibration/camera/rig.hpp"
#include "drivers/camera/stereo_pairing.hpp"

namespace foresight {

struct LensInFile {
  CameraModel camera;
  std::string note;  ///< which of two was taken; "" where the file holds one
};

/// The lens in a result of kind "intrinsics", "stereo" (that of `side`) or "arm", or in a ROS camera_info. Throws
/// InputError: what the file holds instead, what its reader throws.
LensInFile read_lens_file(const std::filesystem::path& file, Side side = Side::left);

/// The cameras of a result of kind "stereo", or the lone one of another file and, from a second camera_info with
/// T_left_right, the right one.
CalibratedCameras read_cameras_file(const std::filesystem::path& file,
                                    const std::optional<std::filesystem::path>& right);

/// What an option that takes one of these says of it.
inline constexpr const char* kLensFile = "result of stereo (its left lens), intrinsics or arm, or camera_info";

}  // namespace foresight

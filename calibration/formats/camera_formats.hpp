// Cameras in the files of other programs, one or a pair.
//
//   camera-info   ROS sensor_msgs/CameraInfo in YAML; a pair is a folder: camera.yaml and
//                 camera_right.yaml with T_left_right, as in a run folder, rectified (rectification.hpp)
//   kalibr        camchain: cam0 (left), cam1 with T_cn_cnm1 (left to right camera coordinates)
//   opencv        cv::FileStorage (.yml, .xml, .json): camera_matrix and distortion_coefficients, or
//                 M1 D1 M2 D2 and R T (left to right), with R1 R2 P1 P2 Q (rectification.hpp);
//                 fisheye_model 1 for equidistant
//   mrcal         .cameramodel; a pair is a folder: left.cameramodel and right.cameramodel, whose
//                 extrinsics are the Rodrigues vector and translation from the left camera
//
// Pixel centres are at integers in all four. Coefficients are OpenCV's in all four, so that nothing is
// converted; what a format cannot hold is refused.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "calibration/camera/camera_model.hpp"

namespace foresight {

enum class CameraFormat { camera_info, kalibr, opencv, mrcal };

std::string to_string(CameraFormat format);

/// Throws InputError naming the nearest format.
CameraFormat parse_camera_format(std::string_view name);

/// Throws InputError naming file and field: missing, damaged, a lens model or a projection that we
/// do not know, coefficients that our models cannot hold, a pair without its pose.
CalibratedCameras read_cameras(CameraFormat format, const std::filesystem::path& path);

struct CameraFileText {
  std::string name;  ///< in the folder; empty: the path itself
  std::string text;
};

/// What write_cameras() writes to `path`, whose ending chooses among FileStorage's forms. Throws
/// InputError where the format cannot hold a lens, naming the formats that can.
std::vector<CameraFileText> format_cameras(CameraFormat format, const CalibratedCameras& cameras,
                                           const std::filesystem::path& path);

struct ExportSummary {
  std::vector<std::filesystem::path> files;
  int rays = 0;         ///< compared per camera
  double worst_px = 0;  ///< largest distance of a ray's pixels
};

/// Writes the file, or the folder of a pair; its bytes are read back first, and kRays rays per camera
/// must meet the same pixels to kMostPx. Throws InputError where `path` exists and `replace` is not
/// set, and like format_cameras(); RuntimeFailure where the rays do not agree or it cannot be
/// written. Nothing is left behind then.
ExportSummary write_cameras(CameraFormat format, const CalibratedCameras& cameras, const std::filesystem::path& path,
                            bool replace);
inline constexpr int kRays = 1000;
inline constexpr double kMostPx = 1e-6;

/// Largest distance, in px, of the pixels that `count` rays of each camera meet in `a` and in `b`. The rays
/// cover the images of `a`, with a point each, 0.3 to 10 m away; those of the right camera pass through
/// the left one's coordinates, so that the pose counts. Infinite where sizes or numbers of cameras differ.
double worst_ray(const CalibratedCameras& a, const CalibratedCameras& b, int count);

}  // namespace foresight

// What the readers and writers of all formats share. Private to calibration/formats.
#pragma once

#include <filesystem>
#include <initializer_list>
#include <string>
#include <vector>

#include "calibration/formats/camera_formats.hpp"

namespace foresight::formats {

/// Coefficients of `camera` in OpenCV's order, as many as the first of `counts` (ascending) that loses nothing.
std::vector<double> coefficients(const CameraModel& camera, std::initializer_list<std::size_t> counts);

/// The smallest perspective model that holds `d` (OpenCV's order, any number). Throws InputError at `where`:
/// more than 12 that are not zero, which is a tilted sensor.
CameraModel perspective(const std::vector<double>& d, const std::string& where);

/// Four coefficients. Throws InputError at `where`.
CameraModel equidistant(const std::vector<double>& d, const std::string& where);

/// Sets size, focal lengths and centre. Throws InputError at `where`: not positive, not finite.
void set_pinhole(CameraModel& camera, const std::vector<double>& size, const std::vector<double>& fx_fy_cx_cy,
                 const std::string& where);

CalibratedCameras read_camera_info_files(const std::filesystem::path& path);
CalibratedCameras read_kalibr(const std::filesystem::path& file);
CalibratedCameras read_opencv(const std::filesystem::path& file);
CalibratedCameras read_mrcal(const std::filesystem::path& path);

std::vector<CameraFileText> camera_info_text(const CalibratedCameras& cameras);
std::vector<CameraFileText> kalibr_text(const CalibratedCameras& cameras);
std::vector<CameraFileText> opencv_text(const CalibratedCameras& cameras, const std::filesystem::path& file);
std::vector<CameraFileText> mrcal_text(const CalibratedCameras& cameras);

/// "[1, 0.5]", each number exact.
std::string list(const std::vector<double>& numbers);

}  // namespace foresight::formats

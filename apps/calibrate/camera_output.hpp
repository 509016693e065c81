// What `intrinsics` and `stereo` deliver: text, numbers, a result file, camera_info files, a report.
#pragma once

#include <filesystem>
#include <optional>

#include "apps/calibrate/camera_input.hpp"
#include "apps/calibrate/outputs.hpp"
#include "apps/command_line/command_line.hpp"
#include "calibration/camera/camera_calibration.hpp"

namespace foresight {

struct CameraOutput {
  CalibrateOutputs files;
  std::optional<std::filesystem::path> camera_info;  ///< folder for camera.yaml and camera_right.yaml
  std::vector<std::string> serials;                  ///< of the cameras, left first
};

void add_camera_output(Command& command, CameraOutput& output);

/// All numbers under the names of --json.
nlohmann::ordered_json camera_numbers(const CameraCalibration& calibration);

/// Prints the summary and writes what was asked for; the result and camera_info only where it is
/// usable. `input`: what it was solved from. Returns 0, or 1 where it is not usable.
int deliver(const CameraCalibration& calibration, const CameraViewsInput& input, const CameraOutput& output);

}  // namespace foresight

// Poses and joint angles for `foresight calibrate pan-tilt`.
#pragma once

#include <filesystem>
#include <optional>

#include "calibration/robot/pan_tilt.hpp"

namespace foresight {

struct PanTiltInput {
  std::optional<std::filesystem::path> poses, angles, images, corners, camera;
  std::string board;
  bool in_order = false;  ///< the samples are in the order in which they were taken
};

/// Poses from files, or of the board in each view by PnP, with the angles row by row. A .yaml of
/// poses may hold its own angles: NAME: {pose: {x, .., qw}, target_joints or camera_joints: [pan, tilt]}.
/// Throws InputError naming file and line.
std::vector<PanTiltSample> read_pan_tilt_samples(const PanTiltInput& input, std::vector<std::string>& notes);

/// Of each image (names without extension): by name where every one has a row of its name, else row by row. Throws
/// InputError where the numbers differ, or a row is wrong.
std::vector<PanTiltAngles> read_angles_of(const std::optional<std::filesystem::path>& file,
                                          const std::vector<std::string>& images);

}  // namespace foresight

// What `intrinsics`, `stereo` and `verify` read: corners from files, or found in images.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "apps/command_line/command_line.hpp"
#include "calibration/camera/rig.hpp"
#include "calibration/target/image_input.hpp"

namespace foresight {

struct CornerInput {
  std::optional<std::filesystem::path> corners;       ///< .vnl, or a folder
  std::optional<std::filesystem::path> images;        ///< of one camera
  std::optional<std::filesystem::path> left, right;   ///< of a pair
  std::optional<std::filesystem::path> test_corners;  ///< corners that only score
  std::string board;
  std::string size;  ///< "WIDTHxHEIGHT" of images that corners came from
};

/// The options of one camera, or of a pair.
void add_camera_input(Command& command, CornerInput& input, bool pair);

struct CameraViewsInput {
  RigViews train;
  RigViews test;                   ///< empty without --test-corners
  PicturesOfViews files;           ///< of `train`, where it was found in images
  std::vector<std::string> notes;  ///< views that were not used, and why
};

/// Throws InputError: no or two sources, what the readers and finders throw.
CameraViewsInput read_camera_input(const CornerInput& input, bool pair);

}  // namespace foresight

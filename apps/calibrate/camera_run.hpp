// What `intrinsics` and `stereo` have in common.
#pragma once

#include "apps/calibrate/camera_input.hpp"
#include "apps/calibrate/camera_output.hpp"
#include "apps/command_line/command_line.hpp"

namespace foresight {

struct CameraRun {
  CornerInput input;
  CameraOutput output;
  std::string model = "auto";
  bool warp = true;
};

void add_camera_run(Command& command, CameraRun& run, bool pair);

/// Reads, solves, delivers. Returns 1 where the result should not be used.
int calibrate_cameras(const CameraRun& run, bool pair);

}  // namespace foresight

// `foresight calibrate pan-tilt` from a static tag map.
#pragma once

#include "apps/calibrate/outputs.hpp"
#include "apps/calibrate/pan_tilt_tag_input.hpp"
#include "apps/command_line/command_line.hpp"

namespace foresight {

struct PanTiltTagCommand {
  PanTiltTagInput input;
  std::optional<std::filesystem::path> time;  ///< result of `calibrate time`
  PanTiltTagOptions solver;
  CalibrateOutputs outputs;
};

/// What is not shared with the other ways to give poses.
void add_tag_options(Command& command, PanTiltTagInput& input);

/// Solves, prints and writes; returns the exit code. Throws what reading and solving do.
int calibrate_from_tags(PanTiltTagCommand& command);

}  // namespace foresight

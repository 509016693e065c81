// `foresight calibrate verify` for a pan-tilt head.
#pragma once

#include "apps/calibrate/pan_tilt_tag_input.hpp"

namespace foresight {

struct PanTiltVerify {
  std::filesystem::path result;               ///< of `calibrate pan-tilt`
  std::optional<std::filesystem::path> time;  ///< of `calibrate time`
  PanTiltTagInput input;
  double encoders_px = 1.0, tags_px = 0.3;  ///< limits, RMS
  std::optional<std::filesystem::path> json;
};

/// Two errors of tag corners: by the encoders alone, of all tags; and of every second tag of the map after the other
/// ones have corrected the pose of their own view. Prints them; returns 0, or 1 where a limit is exceeded. Throws
/// InputError as reading does, and where no view shows tags of both halves.
int verify_head(const PanTiltVerify& options);

}  // namespace foresight

// What a recorder has to know of a rig's cameras.
#pragma once

#include "rig/open_stereo.hpp"
#include "session/run_recorder.hpp"

namespace foresight {

/// How a run of these cameras is recorded: lenses, and for mock ones the scene and the poses that encoders tell.
/// Throws InputError where a real camera has no calibration, or the right one no place.
RecorderOptions recorder_options(const StereoConfig& config, const OpenStereo& opened, const sim::ShaftsAt& shafts);

}  // namespace foresight

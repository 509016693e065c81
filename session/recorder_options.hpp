// What a recorder has to know of live cameras.
#pragma once

#include "session/live_scene.hpp"
#include "session/run_recorder.hpp"

namespace foresight {

/// How a run of these cameras is recorded: lenses, model, and which of its nodes move. Throws InputError where a camera
/// has no calibration.
RecorderOptions recorder_options(const LiveScene& scene);

}  // namespace foresight

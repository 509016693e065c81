// The loop of `foresight record`: from a stereo camera to a recorder, until enough came or none comes.
#pragma once

#include "drivers/camera/stereo_camera.hpp"
#include "session/run_recorder.hpp"

namespace foresight {

struct RecordingLimits {
  std::optional<std::uint64_t> count;               ///< pairs
  std::optional<Duration> length;                   ///< from the first pair on
  Duration silent_after = std::chrono::seconds(5);  ///< without a pair
};

struct RecordingResult {
  RecorderCounts counts;
  StereoStatus cameras;
  std::uint64_t unregistered = 0;  ///< pairs for which the registration was too slow
  std::string fault;               ///< why it ended early: a silent camera, RunRecorder::fault(); "" where it did not
};

/// Starts `cameras` and `frames`, to which `recorder` has subscribed, hands the pairs over, stops them and finishes
/// `recorder`. What was recorded before a fault is kept. Blocks; `stop` is polled at least every 0.1 s. Throws what
/// StereoCamera::start and RunRecorder::finish do; RuntimeFailure where not one pair came, saying why.
RecordingResult record(StereoCamera& cameras, LiveFrames& frames, RunRecorder& recorder, const RecordingLimits& limits,
                       const Clock& clock, const std::function<bool()>& stop);

/// The cameras' counts as lines of YAML for RunRecorder::finish().
std::string camera_remarks(const StereoStatus& status);
std::string registration_remarks(const LiveFrames& frames);

/// Counts in words, one line each; what is 0 is left out but for the pairs.
std::string counts_text(const RecordingResult& result);

}  // namespace foresight

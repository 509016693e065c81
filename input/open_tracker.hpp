// Devices by their names on a command line.
#pragma once

#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "input/tracker_trace.hpp"

namespace foresight {

/// "gamepad", "gamepad:1" (the second one), "spacemouse", or the file of a recording. A device that is not there now
/// may come later. Throws InputError (no such device or recording: the nearest name; `keyboard`, whose events a window
/// has to feed), RuntimeFailure (SDL cannot be used).
std::unique_ptr<Tracker> open_tracker(const std::string& device, const TrackerTraceOptions& options = {});

/// Whether it names a recording.
bool is_recording(const std::string& device);

/// For who drives by it: each of its buttons, and what it does; nothing for a recording.
std::vector<std::pair<std::string, std::string>> keys_of(const std::string& device);

}  // namespace foresight

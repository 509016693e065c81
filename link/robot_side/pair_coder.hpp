// How a pair of images becomes bytes for the line.
#pragma once

#include <functional>

#include "link/messages/foresight_messages.hpp"
#include "session/live_frames.hpp"

namespace foresight::link {

/// Fills `out.coding` and the `data` of both images; false: this pair is not to be sent. One thread: the sender's.
using PairCoder = std::function<bool(const LiveFrame& frame, StereoFrame& out)>;

/// Each image one JPEG of that quality, 1 .. 100.
PairCoder jpeg_coder(int quality);
/// "jpeg": StereoFrame::coding of the above.
inline constexpr const char* kJpeg = "jpeg";

}  // namespace foresight::link

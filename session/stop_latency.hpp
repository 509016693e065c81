// How long the threads of a session wait for what they are there for before they look whether to stop.
#pragma once

#include "common/time.hpp"

namespace foresight {

inline constexpr Duration kStopLatency = std::chrono::milliseconds(100);

}  // namespace foresight

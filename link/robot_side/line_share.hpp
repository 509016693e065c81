// What states leave of a thin line to the pictures.
//
// States of a robot are some 70 kB a second at their usual rates: more than half of a line of 1 Mbit/s. There they go
// less often; what they tell of changes goes at once as ever.
#pragma once

#include <algorithm>
#include <atomic>

#include "common/time.hpp"

namespace foresight::link {

/// What the line carries, as the sender of pictures knows it. Any thread.
struct LineCapacity {
  std::atomic<double> bytes_per_s{0};  ///< 0: not known; nothing has to wait for it
};

/// What one kind of message may take.
struct LineShare {
  std::size_t bytes = 0;  ///< of a message, headers included
  double share = 0;       ///< of the line, 0 .. 1
  Duration longest{0};    ///< between two, however thin the line
};

/// Of the robot's states and of each cycle of the gate: what they have with up to seven joints, RTPS and UDP. Who
/// commands is blind after 0.5 s without.
inline constexpr LineShare kControlShare{500, 0.1, std::chrono::milliseconds(200)};
inline constexpr LineShare kMotionShare{570, 0.1, std::chrono::milliseconds(200)};
inline constexpr LineShare kWordsShare{1700, 0.05, std::chrono::seconds(1)};

/// The time between two messages of which `asked` is the least.
inline Duration thinned(Duration asked, const LineShare& share, double line_bytes_per_s) {
  if (!(line_bytes_per_s > 0)) return asked;
  const Duration affordable = seconds(static_cast<double>(share.bytes) / (share.share * line_bytes_per_s));
  return std::max(asked, std::min(affordable, share.longest));
}

}  // namespace foresight::link

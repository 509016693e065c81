// Sends what a log holds, at the log's pace.
#pragma once

#include <functional>

#include "common/clock.hpp"
#include "drivers/can/can_bus.hpp"
#include "drivers/can/candump_log.hpp"

namespace foresight {

struct ReplayLogOptions {
  double speed = 1;                                     ///< > 0; 2: twice as fast
  Duration gap = std::chrono::milliseconds(1);          ///< between frames without times
  Duration longest_pause = std::chrono::seconds(3600);  ///< longer ones in the log are cut
  /// A frame for which there was no room is tried again for so long.
  Duration patience = std::chrono::milliseconds(100);

  /// Throws InputError.
  void validate() const;
};

struct ReplayLogSummary {
  std::uint64_t sent = 0;
  std::uint64_t error_frames = 0;  ///< in the log; nobody can send them
  std::uint64_t failed = 0;        ///< no room, bus down, or not a frame of this bus
  Duration worst_delay{0};         ///< by which a frame was sent after its time
};

/// Sends each frame of `log` on `bus` at its time after the first. Waits on `clock`; what arrives
/// meanwhile is read and dropped, so that state() stays true. `stop` is asked before each frame and, in
/// longer pauses, ten times a second. Throws what the reader throws.
ReplayLogSummary replay_log(CandumpReader& log, CanBus& bus, Clock& clock, const ReplayLogOptions& options = {},
                            const std::function<bool()>& stop = {});

}  // namespace foresight

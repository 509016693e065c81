// Recordings of devices: our own form, and what others recorded.
//
//   rows of commas with a heading               which columns            what becomes of them
//   our own (input show --record)               all of TrackerState      itself
//   a tool's tip that a person moved            time_s x y z q. gripper  the hand; 100 open .. 30 closed; where rows
//   are
//                                                                        missing, the switch was let go of
//   tracked controllers (WebXR)                 L_grip_x .. R_pressed    the palm; squeeze is switch and clutch, the
//   trigger
//                                                                        the gripper, A or X the home view, B or Y
//                                                                        recentres
//   tracked hands (WebXR)                       L_wrist_x .. R_index_..  the wrist; thumb to index is the gripper
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "input/tracker.hpp"

namespace foresight {

struct TrackerTrace {
  struct Row {
    Duration time{0};    ///< since the begin of the recording; never goes back
    TrackerState state;  ///< its `time` is of no meaning
  };
  /// Numbers for the gripper that are beyond its ends: they count as the nearer end.
  struct Beyond {
    std::string column;
    double open = 0, closed = 1;  ///< the ends
    double least = 0, most = 0;   ///< of all its numbers
    std::size_t rows = 0, of = 0;
  };
  std::string what;  ///< "tracked controllers, right"
  std::vector<Row> rows;
  Beyond beyond;
};

enum class TrackerSide : std::uint8_t { left, right };

struct TrackerTraceOptions {
  TrackerSide side = TrackerSide::right;  ///< of recordings of both hands
  /// As if somebody held switch and clutch whenever the hand has been tracked for a fifth of a second: hands that carry
  /// no switch.
  bool hold_switch = false;
};

inline constexpr std::size_t kMostTraceRows = 2'000'000;

/// Throws InputError naming file, line and column: no such table (the columns that would do), a number that is none,
/// times that go back, a quaternion that is none, more than kMostTraceRows.
TrackerTrace read_tracker_trace(const std::filesystem::path& file, const TrackerTraceOptions& options = {});

/// Our own form: its heading, and a row of it, each with its end of line.
std::string trace_heading();
std::string trace_row(Duration time, const TrackerState& state);

}  // namespace foresight

// When work in slices may go on beside frames that have to be in time and need the same processors.
//
//   frame   |#########|               |#########|                |#########|
//   slices             [--][----][--]            [---][-----]
//                                   ^ the next one would not be done by the next frame: it waits
//
// The overload rule (thesis, chapter 6.3.2, which has 10 ms after each frame instead): frames that leave nothing must
// not stop the work. While it waits, a share of the time is put down for it. A display leaves that much before its next
// frame (rest_due()). Where it does not, a slice runs after a frame whatever follows once it is the slice's worth, and
// once it is 20 ms, even while a frame is drawn. What frames have left beyond the share counts, too: one slow drawing
// makes no further frame late. A slice of more than 50 ms pays for the rest afterwards: what was expected of it may be
// wrong, as that of the first one, which compiles programs.
//
// Where two displays show frames (a window, a headset), slices run in what both leave. A display whose frames must not
// share a processor with a slice that has come to its turn lets it go first, and shows fewer frames: has_turn().
//
// Pure: instants come in; nothing waits here.
#pragma once

#include <array>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "common/time.hpp"

namespace foresight {

/// Whose frames.
enum class FramesOf : std::uint8_t { window, headset };

struct SliceBudgetOptions {
  double least_share = 1.0 / 3;  ///< of the time, for work that waits
  /// A frame that takes longer than this, or that does not begin so long after it was due, holds up nobody: its display
  /// is hidden, or hangs.
  Duration longest_frame = std::chrono::milliseconds(250);
};

/// One thread at a time.
class SliceBudget {
 public:
  explicit SliceBudget(const SliceBudgetOptions& options = {}) : options_(options) {}

  void frame_begins(RobotTime now, FramesOf display = FramesOf::window);
  /// `next`: when the next one is due.
  void frame_ends(RobotTime now, RobotTime next, FramesOf display = FramesOf::window);

  /// Nothing: a slice of this kind may begin. Else it asks again then, or when a frame has ended.
  std::optional<RobotTime> wait(RobotTime now, const std::string& kind, double units = 1);
  /// How long work that waits would have to run from now on to have had its share of the time so far.
  Duration rest_due(RobotTime now) const;
  /// Frames have put a slice off for as long as they may: it runs now, or is to run before the next frame.
  bool has_turn(RobotTime now) const;
  /// A slice of so many units ran. What it cost counts when the next one is planned.
  void ran(RobotTime begin, RobotTime end, const std::string& kind, double units = 1);
  /// How many of `units` a slice of about `slice` is to do that begins now: fewer where the next frame is due before
  /// its end, but not so few that what each slice costs besides would count. At least 1.
  double units_now(RobotTime now, Duration slice, const std::string& kind, double units) const;
  /// So many units take about this long; at least 1. `units` where nothing is known yet.
  double units_within(Duration time, const std::string& kind, double units) const;
  /// By what was measured of this kind; 0: nothing yet.
  Duration expected(const std::string& kind, double units = 1) const;

 private:
  struct Costs {
    std::vector<double> ns;  // of a unit, in a ring
    std::size_t next = 0;
    double longest_ns = 0;  // a quantile of the ring
  };
  struct Frames {
    std::optional<RobotTime> drawing_since, due;
  };
  /// Of the frames that count: those of a display that is hidden, or hangs, do not.
  struct Ahead {
    std::optional<RobotTime> drawn_until;  ///< one is drawn, and counts until then
    std::optional<RobotTime> due;          ///< when the next one begins
  };
  Ahead ahead(RobotTime now) const;
  double owed_ns(RobotTime now) const;

  SliceBudgetOptions options_;
  std::map<std::string, Costs, std::less<>> costs_;
  std::array<Frames, 2> frames_;            // by FramesOf
  std::optional<RobotTime> waiting_since_;  // up to here owed_ns_ is counted
  double owed_ns_ = 0;
  double turn_ns_ = 0;    // owed, at which the slice that waits comes to its turn
  bool in_turn_ = false;  // the slice that runs has come to it
};

}  // namespace foresight

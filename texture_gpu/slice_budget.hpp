// When work in slices may go on beside frames that have to be in time and need the same processors.
//
//   frame   |#########|               |#########|                |#########|
//   slices             [--][----][--]            [---][-----]
//                                   ^ the next one would not be done by the next frame: it waits
//
// The overload rule (thesis, chapter 6.3.2): frames that leave nothing must not stop the work. While it waits, time is
// put down for it; once that is a slice's worth, the slice runs after a frame whatever follows, and once it is 20 ms,
// even while a frame is drawn. A slice of more than 50 ms pays for the rest afterwards: what was expected of it may be
// wrong, as that of the first one, which compiles programs.
//
// Pure: instants come in; nothing waits here.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "common/time.hpp"

namespace foresight {

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

  void frame_begins(RobotTime now);
  /// `next`: when the next one is due.
  void frame_ends(RobotTime now, RobotTime next);

  /// Nothing: a slice of this kind may begin. Else it asks again then, or when a frame has ended.
  std::optional<RobotTime> wait(RobotTime now, const std::string& kind, double units = 1);
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
  SliceBudgetOptions options_;
  std::map<std::string, Costs, std::less<>> costs_;
  std::optional<RobotTime> drawing_since_, due_;
  std::optional<RobotTime> waiting_since_;  // up to here owed_ns_ is counted
  double owed_ns_ = 0;
};

}  // namespace foresight

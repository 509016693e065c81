// How long the robot's reports keep the seat waiting, or set-points the robot, and what that says of the gap that lasts
// now.
//
// What keeps reports away keeps set-points away, and the robot stops once none of those that it has lasts any more.
// Over a line that stands still for a tenth of a second now and then, and goes on each time, that a report is late
// tells little; over one that had no such gap yet, or long ones, it may be the begin of a long one.
#pragma once

#include "prediction/last_of.hpp"

namespace foresight {

/// One thread. Allocates at the start only; no method but the constructor throws. All times in s.
class LineGaps {
 public:
  static constexpr double kNotable = 0.05;  ///< shorter gaps are nobody's concern

  /// `longest`: what is longer counts as that.
  explicit LineGaps(double longest) : longest_(longest), notable_(kKept) {}

  /// A report (or set-point, likewise below) came at `now`, so long after the one before.
  void add(double gap, double now) noexcept;
  /// What 95 % of the gaps do not exceed.
  double usual() const noexcept { return usual_; }
  /// How probable it is that a gap that has lasted `so_far` comes to `length`: by those of the last minute that lasted
  /// as long, with Jeffreys' prior for a share of which nothing is known (0.5 without any).
  double chance_to_reach(double length, double so_far) const noexcept;
  /// How long a gap that has lasted `so_far` usually is, >= that: by those, and one twice as long as it is so far.
  double expected_length(double so_far) const noexcept;

 private:
  static constexpr std::size_t kKept = 256;
  struct Gap {
    double length = 0, ended = 0;
  };

  double longest_;
  double usual_ = 0.05;
  double newest_ = 0;
  LastOf<Gap> notable_;
};

}  // namespace foresight

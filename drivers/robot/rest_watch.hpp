// Whether a robot stands still, by what its drives measure.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "drivers/drive/drive.hpp"

namespace foresight {

/// A joint is at rest once its position stays within a thousandth of a second's way at its largest velocity for 0.1 s
/// (so it moves at less than a hundredth of that velocity), and its drive neither homes nor tells of more speed. Where
/// the drive does not tell (offline, old or contradictory feedback), nobody can know: then 1 s without a sign of motion
/// has to do, in which its own watchdog has stopped it.
///
/// One thread. Does not allocate after construction.
class RestWatch {
 public:
  /// `velocities`: the joints' largest ones; > 0. `feedback_age_s`: older positions are old.
  RestWatch(std::vector<double> velocities, double feedback_age_s);
  /// Every cycle, with one feedback per joint.
  void see(std::span<const DriveFeedback> feedback, RobotTime now) noexcept;
  bool at_rest() const noexcept;

 private:
  struct Joint {
    double velocity = 0;  // the largest
    double anchor = 0;
    RobotTime moved;  // when a sign of motion was last seen
    bool rests = false;
  };
  std::vector<Joint> joints_;
  Duration feedback_age_;
  bool begun_ = false;
};

}  // namespace foresight

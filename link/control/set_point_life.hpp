// How long a set-point may last on the line as it is.
#pragma once

#include <vector>

#include "common/time.hpp"

namespace foresight {

struct SetPointLifeOptions {
  Duration least = std::chrono::milliseconds(100);   ///< on a LAN, and while nothing is known
  Duration widest = std::chrono::milliseconds(250);  ///< beside the spread
  Duration most_spread = std::chrono::milliseconds(250);
  /// Lines whose least delay alone outlasts `widest` carry no commands, unless somebody who knows where the robot
  /// stands allows for that delay, up to this much. Their age is known but for the clocks' uncertainty, which is half
  /// of the round trip: this is to be all of it.
  Duration allowed_delay{0};
};

/// From the ages of the set-points of the last ten seconds when they came: what nearly all of them need, and a margin
/// for one that is lost; but not more than `widest` and the ages' spread. One thread.
class SetPointLife {
 public:
  explicit SetPointLife(SetPointLifeOptions options = {});
  /// `age`: when it came, at most.
  void came(Duration age, RobotTime now);
  Duration life() const { return life_; }
  void forget();

 private:
  struct Sample {
    RobotTime at;
    Duration age;
  };
  void measure(RobotTime now);

  SetPointLifeOptions options_;
  std::vector<Sample> samples_;  // a ring
  std::size_t next_ = 0;
  std::vector<Duration> sorted_;
  RobotTime measured_;
  Duration life_;
};

}  // namespace foresight

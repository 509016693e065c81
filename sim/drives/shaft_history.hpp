// Where shafts were a moment ago.
#pragma once

#include <span>
#include <vector>

#include "common/time.hpp"

namespace foresight::sim {

/// The last positions of some shafts, at steps of time; in between they are interpolated. Allocates at the start only.
/// One thread.
class ShaftHistory {
 public:
  /// Of `shafts` shafts, the last `steps` (> 0) steps.
  ShaftHistory(std::size_t shafts, std::size_t steps);
  /// One position per shaft, rad or m, `time` later than at the last call.
  void add(RobotTime time, std::span<const double> positions);
  /// Straight between the steps; before the oldest and after the newest, as there. At least one add() came before.
  double at(std::size_t shaft, RobotTime time) const;

 private:
  std::size_t place(std::size_t age) const;  ///< of the step; 0: the oldest

  std::size_t shafts_;
  std::vector<RobotTime> times_;
  std::vector<double> positions_;  // of each step, all shafts
  std::size_t next_ = 0, count_ = 0;
};

}  // namespace foresight::sim

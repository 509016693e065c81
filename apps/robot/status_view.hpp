// The robot's state as text for a terminal.
#pragma once

#include <string>
#include <vector>

#include "drivers/robot/rig.hpp"
#include "drivers/robot/robot.hpp"

namespace foresight {

/// A bus as the view shows it.
struct BusLine {
  std::string name;
  CanBusState state = CanBusState::active;
  CanCounters counters;
  double load = 0;  ///< share of its bit rate in use, 0 .. 1
};

/// Several lines: phase and reason, a line per joint, a line per bus, punctuality of the loop. `selected`: the joint
/// that the keys move, or -1.
std::string status_text(const Rig& rig, const RobotStatus& status, const std::vector<BusLine>& buses, int selected);

}  // namespace foresight

// Whether a task was done, in truth.
#pragma once

#include <string>

#include "sim/physics/physical_lab.hpp"

namespace foresight::sim {

/// Does the thing lie in a tray that is there (lies_in_tray()), where it hardly moved in the tenth of a second up to
/// `time`? What flies past or is carried over it does not. Throws as PhysicalLab::thing_at().
bool rests_in_tray(PhysicalLab& physics, const std::string& thing, const Pose& T_world_tray, RobotTime time);

}  // namespace foresight::sim

// Racks for those who have none of their own: an arm of seven joints and a pan-tilt head.
#pragma once

#include <vector>

#include "sim/drives/drive_node.hpp"

namespace foresight::sim {

/// Nine PowerCube modules: arm_1 .. arm_7 with ids 1 .. 7, pan with 8 and tilt with 9. Not homed.
std::vector<NodeConfig> powercube_rack();
/// Nine CiA 402 drives with absolute encoders: arm_1 .. arm_7 with nodes 3 .. 9, pan with 10 and tilt with 11.
std::vector<NodeConfig> cia402_rack();

}  // namespace foresight::sim

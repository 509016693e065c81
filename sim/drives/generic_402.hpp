// The object dictionary of a typical CiA 402 servo drive, for racks without a maker's file.
#pragma once

#include "sim/drives/object_dictionary.hpp"

namespace foresight::sim {

/// Communication objects of CiA 301 (four PDOs each way, one heartbeat consumer entry for four masters) and the
/// objects of CiA 402-2 and -3 for profile position, homing, interpolated and cyclic synchronous modes.
/// Values as after power on of node `node`. PDO 1 is mapped (6040h; 6041h), the others are invalid and empty.
ObjectDictionary generic_402(int node);

}  // namespace foresight::sim

// How busy a rig's buses will be.
#pragma once

#include "rig/rig.hpp"

namespace foresight {

/// More is refused: what is left is for retries, configuration and faults.
inline constexpr double kMostBusLoad = 0.7;

inline constexpr double kSlowestLoopHz = 10, kFastestLoopHz = 2000;  ///< of a control loop

/// Share of the bus's bit rate, 0 .. 1 or more, that its drives and the master will use at the rig's rate, counting the
/// most stuff bits. PowerCube: a set-point of 8 bytes and an answer of 8 for each joint and cycle, a watchdog every 40
/// ms. CiA 402: SYNC, RPDO1 and TPDO1 of 6 bytes and TPDO2 of 5 for each joint and cycle, heartbeats every 20 ms both
/// ways.
double planned_bus_load(const Rig& rig, std::size_t bus);

/// Throws InputError naming the bus where that is more than kMostBusLoad, with a rate at which it would not be, if
/// there is one.
void require_room_on_buses(const Rig& rig);

}  // namespace foresight

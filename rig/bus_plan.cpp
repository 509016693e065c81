#include "rig/bus_plan.hpp"

#include <algorithm>
#include <cmath>

#include "common/error.hpp"
#include "drivers/can/can_bits.hpp"

namespace foresight {
namespace {

constexpr double kWatchdogHz = 100, kHeartbeatHz = 50;

double bits(std::uint8_t bytes) {
  CanFrame frame;
  frame.size = bytes;
  return worst_can_bits(frame).total();
}

}  // namespace

double planned_bus_load(const Rig& rig, std::size_t bus) {
  const auto joints = static_cast<double>(
      std::count_if(rig.joints.begin(), rig.joints.end(), [&](const RigJoint& j) { return j.bus == bus; }));
  double bits_per_second = 0;
  if (rig.buses[bus].protocol == DriveProtocol::powercube)
    bits_per_second = joints * rig.rate_hz * 2 * bits(8) + kWatchdogHz * bits(1);
  else
    bits_per_second =
        rig.rate_hz * (bits(0) + joints * (2 * bits(6) + bits(5))) + kHeartbeatHz * (joints + 1) * bits(1);
  return bits_per_second / rig.buses[bus].bit_rate;
}

void require_room_on_buses(const Rig& rig) {
  for (std::size_t i = 0; i < rig.buses.size(); ++i) {
    const double load = planned_bus_load(rig, i);
    if (load <= kMostBusLoad) continue;
    const double rate_hz = std::floor(0.98 * rig.rate_hz * kMostBusLoad / load);
    throw InputError(
        "bus '" + rig.buses[i].name + "' of rig '" + rig.name + "'",
        "its drives would fill " + std::to_string(std::lround(100 * load)) + " % of it, more than " +
            std::to_string(std::lround(100 * kMostBusLoad)) + " %",
        (rate_hz < kSlowestLoopHz ? "" : "set control.rate_hz to " + std::to_string(std::lround(rate_hz)) + ", ") +
            "raise bit_rate, or put some joints on another bus");
  }
}

}  // namespace foresight

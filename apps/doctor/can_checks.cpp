// CAN interfaces, the rig's buses and the drives on them.
#include <cmath>

#include "apps/doctor/findings.hpp"
#include "common/error.hpp"
#include "drivers/can/can_interfaces.hpp"
#include "rig/bus_plan.hpp"
#include "rig/robot_devices.hpp"

namespace foresight::doctor {
namespace {

std::string percent(double share) {
  return std::to_string(std::lround(100 * share)) + " %";
}

std::string description(const CanInterface& interface) {
  std::string out = interface.kind + ", " + to_string(interface.state);
  if (interface.bit_rate) out += ", " + std::to_string(*interface.bit_rate / 1000) + " kbit/s";
  if (interface.bus_offs.value_or(0) > 0) out += ", was bus-off " + std::to_string(*interface.bus_offs) + " times";
  return out;
}

Finding check_interface(const RigBus& bus, const std::string& subject) {
  const auto interface = find_can_interface(bus.interface);
  const std::string up =
      "sudo ip link set " + bus.interface + " up type can bitrate " + std::to_string(bus.bit_rate) + " restart-ms 100";
  if (!interface)
    return {Verdict::bad, subject, "there is no interface " + bus.interface,
            "plug its adapter in (`ip link show type can` lists what is there), or correct `interface` in the rig"};
  if (!interface->up) return {Verdict::bad, subject, bus.interface + " is down", up};
  if (interface->bit_rate && *interface->bit_rate != bus.bit_rate)
    return {Verdict::bad, subject,
            bus.interface + " runs at " + std::to_string(*interface->bit_rate) + " bit/s, the rig wants " +
                std::to_string(bus.bit_rate),
            "sudo ip link set " + bus.interface + " down; " + up};
  if (interface->state == CanBusState::bus_off)
    return {Verdict::bad, subject, bus.interface + " is bus-off", how_to_restart(*interface)};
  if (interface->state != CanBusState::active)
    return {Verdict::poor, subject, bus.interface + " is " + to_string(interface->state) + ": frames get lost",
            "check cables, the two 120 ohm resistors and that all devices run at the same bit rate"};
  return {Verdict::good, subject, description(*interface), ""};
}

}  // namespace

Findings check_can() {
  if (!has_can_sockets())
    return {
        {Verdict::absent, "CAN", "this kernel has no CAN sockets", "sudo modprobe can_raw; mock buses work without"}};
  Findings out;
  for (const CanInterface& interface : can_interfaces())
    out.push_back(
        interface.up ? Finding{Verdict::good, "CAN " + interface.name, description(interface), ""}
                     : Finding{Verdict::absent, "CAN " + interface.name, "down", "sudo " + how_to_bring_up(interface)});
  if (out.empty())
    out.push_back({Verdict::absent, "CAN", "no interface",
                   "plug an adapter in, or, for trials, sudo ip link add dev vcan0 type vcan"});
  return out;
}

Findings check_buses(const Rig& rig) {
  Findings out;
  for (std::size_t i = 0; i < rig.buses.size(); ++i) {
    const RigBus& bus = rig.buses[i];
    const std::string subject = "bus " + bus.name;
    out.push_back(bus.interface == "mock" ? Finding{Verdict::good, subject, "mock", ""}
                                          : check_interface(bus, subject));
    const double load = planned_bus_load(rig, i);
    out.push_back({load > kMostBusLoad ? Verdict::bad : Verdict::good, subject, "its drives will fill " + percent(load),
                   load > kMostBusLoad
                       ? "lower control.rate_hz, raise bit_rate, or use another bus: at most " + percent(kMostBusLoad)
                       : ""});
  }
  return out;
}

Findings check_drives(const Rig& rig) {
  MonotonicClock clock;
  Findings out;
  try {
    RobotDevices devices(rig, clock, {});
    for (Drive* drive : devices.drives()) {
      const std::string subject = "drive " + drive->config().name;
      try {
        drive->identify();
        out.push_back(
            {Verdict::good, subject,
             "answers as node " + std::to_string(drive->config().node) + " (" + to_text(drive->identity()) + ")", ""});
      } catch (const std::exception& error) {
        out.push_back({Verdict::bad, subject, error.what(), ""});
      }
    }
  } catch (const std::exception& error) {
    out.push_back({Verdict::bad, "drives", error.what(), ""});
  }
  return out;
}

}  // namespace foresight::doctor

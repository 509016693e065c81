// A PowerCube module as a script: answers as the protocol says, with faults to order.
#pragma once

#include <map>
#include <set>
#include <vector>

#include "drivers/can/in_process_bus.hpp"
#include "drivers/powercube/network.hpp"

namespace foresight::powercube {

/// Lives on a SteppedClock, with a control cycle of 1 ms. Moves at once to where FSTEP says, at `velocity` by FRAMP and
/// homes in `homing_takes`.
class ScriptedModule {
 public:
  ScriptedModule(InProcessBus& bus, SteppedClock& clock, int id);

  // What it is and does.
  std::map<Param, double> values;
  std::uint32_t state = kHalted;
  double position = 0.25;
  double velocity = 1;  // of ramps

  // What goes wrong.
  bool silent = false;  ///< without power or cable: hears and says nothing
  std::set<Param> read_only;
  bool deaf_to_reset = false;
  bool never_ends_homing = false;
  Duration homing_takes = std::chrono::milliseconds(200);

  // What it saw.
  std::vector<double> steps, ramps;
  std::vector<RobotTime> refreshes;
  int resets = 0, halts = 0, homes = 0;

  void lose_power();  ///< comes back halted and not homed, with default values

 private:
  void cycle(RobotTime now);
  void hear(const Message& message, RobotTime now);
  void order(Command what, RobotTime now);
  void move(const Message& message);
  void tell(Param param);

  std::unique_ptr<CanBus> bus_;
  int id_;
  RobotTime home_end_, fed_{-1};
  std::optional<double> ramp_target_;
};

}  // namespace foresight::powercube

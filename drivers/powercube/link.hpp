// Questions and answers with modules while the loop does not run yet.
#pragma once

#include <string>

#include "common/clock.hpp"
#include "drivers/can/can_bus.hpp"
#include "drivers/powercube/protocol.hpp"

namespace foresight::powercube {

/// The bus as a drive's set-up sees it. Blocking, one thread; used before the loop only, because it throws away every
/// frame that is not the answer it waits for. Keeps the modules' watchdogs fed while it waits.
class Link {
 public:
  Link(CanBus& bus, Clock& clock) : bus_(bus), clock_(clock) {}

  CanBus& bus() { return bus_; }
  /// The parameter's value, asked for up to three times within 300 ms. `who` names the module in messages.
  /// Throws RuntimeFailure where no answer comes or the bus is down.
  double get(int module, Param param, const std::string& who);
  /// Writes, then reads back: what the module has now. Throws as get().
  double set(int module, Param param, double value, const std::string& who);
  /// The next message within `timeout`, whoever sends it; kind unknown: none, or one that we do not know.
  Message receive(Duration timeout);
  /// Throws RuntimeFailure, naming bus, module and operation, where the frame does not leave.
  void send(const CanFrame& frame, const std::string& who);
  RobotTime now() const { return clock_.now(); }

 private:
  void feed_watchdogs();

  CanBus& bus_;
  Clock& clock_;
  RobotTime fed_{-1'000'000'000};
};

}  // namespace foresight::powercube

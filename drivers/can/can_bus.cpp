#include "drivers/can/can_bus.hpp"

namespace foresight {

const char* to_string(CanBusState state) {
  switch (state) {
    case CanBusState::active: return "error-active";
    case CanBusState::warning: return "error-warning";
    case CanBusState::passive: return "error-passive";
    case CanBusState::bus_off: return "bus-off";
    case CanBusState::down: return "down";
  }
  return "?";
}

}  // namespace foresight

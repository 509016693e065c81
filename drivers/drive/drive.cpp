#include "drivers/drive/drive.hpp"

namespace foresight {

const char* to_string(DriveState state) {
  switch (state) {
    case DriveState::offline: return "offline";
    case DriveState::disabled: return "disabled";
    case DriveState::enabling: return "enabling";
    case DriveState::enabled: return "enabled";
    case DriveState::homing: return "homing";
    case DriveState::stopping: return "stopping";
    case DriveState::fault: return "fault";
  }
  return "?";
}

}  // namespace foresight

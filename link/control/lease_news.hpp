// Who commands and who asks for control, in words for people beside the robot.
#pragma once

#include <string>

#include "link/control/control_desk.hpp"

namespace foresight {

/// One thread, that of the desk. To be asked every 10 ms or so: what begins and ends in between is not told.
class LeaseNews {
 public:
  /// What has changed since the last call, such as "'bert' commands, no longer 'anna'"; mostly "".
  std::string of(ControlDesk& desk, RobotTime now);
  /// As of the last call, in one line: "'anna' commands; 'bert' asks for control: g gives it"; "" where nobody does.
  std::string line() const;

 private:
  Nonce lease_ = 0;
  std::string holder_, asking_;
};

}  // namespace foresight

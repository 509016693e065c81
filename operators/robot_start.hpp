// From drives that stand without torque to a robot that can be driven: enabled and, where it may, homed.
#pragma once

#include <optional>
#include <string>

#include "drivers/robot/robot.hpp"

namespace foresight {

/// Asks for each thing once. Pure logic, one thread.
class RobotStart {
 public:
  /// `may_home`: somebody consents to joints that look for home.
  explicit RobotStart(bool may_home) : may_home_(may_home) {}

  struct Progress {
    bool ready = false;
    RobotRequest request = RobotRequest::none;  ///< to be asked for now
    std::string failure = {};                   ///< why it does not come so far; "" while it may
  };
  /// About every 10 ms, until it is ready or fails.
  Progress tick(RobotTime now, const RobotStatus& status);

 private:
  enum class Step { enable, home };
  Progress ask(RobotRequest request);

  bool may_home_;
  Step step_ = Step::enable;
  bool asked_ = false;
  std::optional<RobotTime> since_;
};

}  // namespace foresight

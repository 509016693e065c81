// A robot's control loop, started and ended.
#pragma once

#include <functional>
#include <string>
#include <thread>

#include "rig/robot_devices.hpp"

namespace foresight {

/// The control loop in real time, in a thread of its own, as long as this lives. The end of it stops the robot under
/// control and waits until it has. Any thread.
class RobotLoop {
 public:
  using Say = std::function<void(const std::string&)>;

  /// Identifies and configures the drives, and returns once the loop runs. `say` gets what there is to tell of it, also
  /// later, in the loop's thread. All must outlive this. Throws what RobotDevices::bring_up() does.
  RobotLoop(MonotonicClock& clock, Robot& robot, RobotDevices& devices, Say say);

 private:
  std::jthread thread_;
};

/// Stepped time needs mock drives, and mock cameras where `cameras` are used: throws InputError naming what is real.
/// `mock`: everything is, whatever the rig says.
void require_mock(const Rig& rig, bool mock, bool cameras);

}  // namespace foresight

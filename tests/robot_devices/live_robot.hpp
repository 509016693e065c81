// A rig with emulated drives in stepped time, its master and an operator.
#pragma once

#include <gtest/gtest.h>

#include <map>
#include <memory>

#include "drivers/robot/robot.hpp"
#include "rig/robot_devices.hpp"

namespace foresight {

/// The drives' own limits are off: what is kept is kept by the gate.
class LiveRobot {
 public:
  explicit LiveRobot(const std::string& rig_file);
  /// `start`: where shafts stand at first, by joint, in its unit.
  explicit LiveRobot(Rig rig, std::map<std::string, double> start = {});

  /// Lets time pass; the control loop runs unless `frozen`.
  void run(Duration time, bool frozen = false);
  /// Enabled, homed, an operator in charge, and all joints of arm and head on their way to and fro.
  void get_moving();
  /// As run(), while the operator goes on.
  void move(Duration time);

  Robot& robot() { return *robot_; }
  RobotDevices& devices() { return *devices_; }
  const Rig& rig() const { return rig_; }
  SteppedClock& clock() { return clock_; }
  /// A command of the operator's, with the targets of the motion at this instant.
  MotionCommand command(bool deadman = true);
  std::size_t joint(const std::string& name) const;
  sim::ShaftState shaft(std::size_t joint) const;
  void inject(const std::string& name, sim::DriveFault fault, double value = 0);
  double fastest() const;  ///< of all shafts now, as a share of the joint's velocity limit

  /// No shaft has ever been beyond its joint's limits of position and velocity, or of acceleration where asked for.
  void expect_limits_kept(const char* when, bool accelerations = false);
  void expect_at_rest(const char* when);

 private:
  Rig rig_;
  SteppedClock clock_;
  std::unique_ptr<RobotDevices> devices_;
  std::unique_ptr<RobotShape> shape_;
  std::unique_ptr<Robot> robot_;
  std::vector<std::pair<std::size_t, std::size_t>> place_;  // of each joint: bus and place in its rack
  RobotTime next_;
  std::uint64_t sequence_ = 0;
  double phase_ = 0;
};

}  // namespace foresight

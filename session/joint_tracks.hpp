// Where a robot's joints were, by its encoders.
#pragma once

#include <vector>

#include "calibration/registration/head_kinematics.hpp"
#include "drivers/robot/robot.hpp"

namespace foresight {

/// Where all joints of a robot were at one instant, each interpolated from its own stamped samples.
struct JointState {
  RobotTime time;                             ///< on the encoders' clock: the cameras' with the calibrated offset
  StateStatus status = StateStatus::invalid;  ///< of the worst joint; `invalid`: positions say nothing
  std::vector<double> positions;              ///< rad or m, in the rig's order; empty without a robot
};

/// All joints of a robot, each with the instants at which its own drive told its positions. One thread.
class JointTracks {
 public:
  explicit JointTracks(std::size_t joints) : tracks_(joints, ShaftTrack(HeadAxis{})) {}
  /// Only of joints that are homed: before, they tell no position.
  void add(const RobotCycle& cycle);
  /// On the encoders' clock.
  JointState at(RobotTime encoder_time) const;
  /// Have all joints told of that instant?
  bool know(RobotTime encoder_time) const;

 private:
  std::vector<ShaftTrack> tracks_;
};

}  // namespace foresight

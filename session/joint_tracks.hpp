// Where a robot's joints were, by its encoders.
#pragma once

#include <limits>
#include <string>
#include <vector>

#include "calibration/registration/head_kinematics.hpp"
#include "drivers/robot/robot.hpp"

namespace foresight {

/// Where all joints of a robot were at one instant, each interpolated from its own stamped samples.
struct JointState {
  RobotTime time;                             ///< on the encoders' clock: the cameras' with the calibrated offset
  StateStatus status = StateStatus::invalid;  ///< of the worst joint; `invalid`: positions say nothing
  std::vector<double> positions;              ///< rad or m, in the rig's order; empty without a robot
  /// Of each joint: is its position that of the instant? Else it is the last that its drive told, or not a number.
  std::vector<bool> known = {};
};

/// Why nobody knows where a robot stands, of JointState::known: "4 of 10 joints tell no position; home them (H)", with
/// the key of who reads it; "" where all are known.
std::string unknown_joints(const std::vector<bool>& known, char key);

/// All joints of a robot, each with the instants at which its own drive told its positions. One thread.
class JointTracks {
 public:
  explicit JointTracks(std::size_t joints) : tracks_(joints, ShaftTrack(HeadAxis{})), told_(joints) {}
  /// Only of joints that are homed: before, they tell no position.
  void add(const RobotCycle& cycle);
  /// On the encoders' clock.
  JointState at(RobotTime encoder_time) const;
  /// The newest instant that all joints have told of which still tell anything; 0 before any has.
  RobotTime newest() const;
  /// Have all joints told of that instant that still tell anything? One that has been silent for long is not waited
  /// for.
  bool know(RobotTime encoder_time) const;

 private:
  struct Told {
    RobotTime time;
    double position = std::numeric_limits<double>::quiet_NaN();
  };
  std::vector<ShaftTrack> tracks_;
  std::vector<Told> told_;  // last, of each joint
};

}  // namespace foresight

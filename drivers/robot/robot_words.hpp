// What a robot does, and why, for the people beside it: one table of all states and reasons, each with its cure.
#pragma once

#include <span>
#include <string>

#include "drivers/robot/robot.hpp"

namespace foresight {

/// Words for one state or reason. Static text.
struct StateWords {
  const char* label;  ///< a word or two, for logs and tables
  const char* name;   ///< what is the case; a clause without a full stop
  const char* cure;   ///< what to do about it, or what comes next; an imperative clause
};

StateWords words_for(RobotPhase phase);
StateWords words_for(GateState state);
/// Of GateReason::none, all are empty.
StateWords words_for(GateReason reason);
StateWords words_for(DriveState state);

/// A joint's name and the unit of its positions, "rad" or "m".
struct JointWords {
  std::string name, unit;
};

/// What a robot is doing, and what to do about it.
struct RobotWords {
  std::string name;  ///< "stopped by the operator; drives hold"
  std::string cure;  ///< "" where nothing is to be done
};
/// `joints`: all of them, in the order of the gate's.
RobotWords describe(const RobotStatus& status, std::span<const JointWords> joints);

/// "0.312 rad"
std::string position_text(double position, const std::string& unit);
/// "joint elbow stands at 0.312 rad and should be at 1.200 rad"
std::string place_text(const JointWords& joint, double stands, double should);
/// "link 'arm_5' comes too close to obstacle 'table' (21.3 mm apart, 20.0 mm are kept)"
std::string parts_text(const GateHold& hold);
/// The two before, with ": " between; the parts alone where the joint, as it would be written, stands where it should.
std::string held_text(const GateHold& hold, const JointWords& joint);
/// "held for 3.2 s: ", then held_text(); "" where nothing holds the robot back.
std::string hold_text(const GateHold& hold, std::span<const JointWords> joints, RobotTime now);

}  // namespace foresight

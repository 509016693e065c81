// Between the hand and the line: what HandControl has to know of the robot, as the operator's seat knows it.
#pragma once

#include "input/hand_control.hpp"
#include "link/control/control_seat.hpp"

namespace foresight {

/// Asked before each cycle(); after it, ControlSeat::command() gets the cycle's positions and its switch, where it has
/// joints.
HandRobot hand_robot(const ControlSeat& seat, OperatorTime now);

}  // namespace foresight

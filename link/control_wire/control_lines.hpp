// Control's messages over DDS: from the desk to all operators, and from each operator to the desk.
#pragma once

#include "link/control/control_desk.hpp"
#include "link/control/control_seat.hpp"
#include "link/dds/endpoints.hpp"

namespace foresight::link {

/// The robot's end. One thread: that of the desk.
class DeskLine {
 public:
  explicit DeskLine(Participant& participant);
  void receive(ControlDesk& desk, RobotTime now);  ///< what has come, to the desk
  void send(ControlDesk& desk);                    ///< what the desk has to say

 private:
  Reader in_;
  Writer out_;
};

/// An operator's end. One thread: that of the seat.
class SeatLine {
 public:
  explicit SeatLine(Participant& participant);
  void receive(ControlSeat& seat, OperatorTime now);
  void send(ControlSeat& seat);

 private:
  Reader in_;
  Writer out_;
};

}  // namespace foresight::link

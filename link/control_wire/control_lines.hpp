// Control's messages over DDS: from the desk to all operators, and from each operator to the desk.
//
// The clock is read for each message that is taken in: a thread that is put aside after one look at its clock would see
// what came meanwhile as sent in the future, which is how a clock looks that jumped.
#pragma once

#include "common/clock.hpp"
#include "link/control/control_desk.hpp"
#include "link/control/control_seat.hpp"
#include "link/dds/endpoints.hpp"

namespace foresight::link {

/// The robot's end. One thread: that of the desk.
class DeskLine {
 public:
  explicit DeskLine(Participant& participant);
  void receive(ControlDesk& desk, const Clock& clock);  ///< what has come, to the desk
  void send(ControlDesk& desk);                         ///< what the desk has to say

 private:
  Reader in_;
  Writer out_;
};

/// An operator's end. One thread: that of the seat.
class SeatLine {
 public:
  explicit SeatLine(Participant& participant);
  void receive(ControlSeat& seat, const Clock& clock);
  void send(ControlSeat& seat);

 private:
  Reader in_;
  Writer out_;
};

}  // namespace foresight::link

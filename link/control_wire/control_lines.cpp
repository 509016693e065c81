#include "link/control_wire/control_lines.hpp"

#include "link/control_wire/control_wire.hpp"

namespace foresight::link {
namespace {

// The newest of each writer: what is older repeats itself, or has expired. Room for what comes between two looks.
constexpr int kRoom = 64;

Topic from_operators() {
  return {"rt/foresight/control/operator/messages", kFromOperatorType, Delivery::newest, kRoom};
}
Topic from_robots() {
  return {"rt/foresight/control/robot/messages", kFromRobotType, Delivery::newest, kRoom};
}

}  // namespace

DeskLine::DeskLine(Participant& participant) : in_(participant, from_operators()), out_(participant, from_robots()) {}

void DeskLine::receive(ControlDesk& desk, const Clock& clock) {
  in_.take([&](const Sample& sample) {
    std::string why;
    if (const auto message = from_operator(sample.cdr, &why))
      desk.receive(*message, clock.now());
    else
      in_.refuse(why);
  });
}

void DeskLine::send(ControlDesk& desk) {
  for (const FromRobot& message : desk.take_outgoing()) out_.write(to_bytes(message));
}

SeatLine::SeatLine(Participant& participant) : in_(participant, from_robots()), out_(participant, from_operators()) {}

void SeatLine::receive(ControlSeat& seat, const Clock& clock) {
  in_.take([&](const Sample& sample) {
    std::string why;
    if (const auto message = from_robot(sample.cdr, &why))
      seat.receive(*message, {clock.now().ns});
    else
      in_.refuse(why);
  });
}

void SeatLine::send(ControlSeat& seat) {
  for (const FromOperator& message : seat.take_outgoing()) out_.write(to_bytes(message));
}

}  // namespace foresight::link

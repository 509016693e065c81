// Who commands over the line, as one of the robot's commanders.
#pragma once

#include "common/suspension.hpp"
#include "link/control_wire/control_lines.hpp"
#include "link/robot_side/line_share.hpp"
#include "link/robot_side/set_point_history.hpp"
#include "operators/line_operator.hpp"

namespace foresight::link {

/// LineOperator with its line: messages are taken in before each tick, and sent after it. One thread.
class ServedOperator final : public Commander {
 public:
  /// `capacity`: null, or of the line; must outlive this.
  ServedOperator(Participant& participant, const GateOptions& gate, ControlDeskOptions desk,
                 const LineCapacity* capacity = nullptr, SuspensionWatch suspension = SuspensionWatch())
      : line_(participant), operator_(gate, std::move(desk)), capacity_(capacity), suspension_(std::move(suspension)) {}

  std::uint64_t operator_id() const override { return operator_.operator_id(); }
  OperatorWish tick(RobotTime now, const RobotStatus& status) override {
    if (suspension_.woke()) operator_.desk().stood_still();
    if (capacity_) operator_.desk().repeat_states_every(thinned({}, kControlShare, capacity_->bytes_per_s));
    line_.receive(operator_.desk(), now);
    OperatorWish wish = operator_.tick(now, status);
    line_.send(operator_.desk());
    taken_.add(operator_.desk().taken());
    return wish;
  }

  ControlDesk& desk() { return operator_.desk(); }
  /// For any thread.
  const SetPointHistory& taken() const { return taken_; }

 private:
  DeskLine line_;
  LineOperator operator_;
  const LineCapacity* capacity_;
  SuspensionWatch suspension_;
  SetPointHistory taken_;
};

}  // namespace foresight::link

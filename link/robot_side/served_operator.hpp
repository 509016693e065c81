// Who commands over the line, as one of the robot's commanders.
#pragma once

#include <algorithm>

#include "common/suspension.hpp"
#include "link/control_wire/control_lines.hpp"
#include "link/robot_side/command_history.hpp"
#include "link/robot_side/line_share.hpp"
#include "operators/line_operator.hpp"

namespace foresight::link {

/// LineOperator with its line: messages are taken in before each tick, and sent after it. One thread.
class ServedOperator final : public Commander {
 public:
  /// `clock`: that of tick(). `capacity`: null, or of the line. Both must outlive this.
  ServedOperator(Participant& participant, const GateOptions& gate, ControlDeskOptions desk, const Clock& clock,
                 const LineCapacity* capacity = nullptr, SuspensionWatch suspension = SuspensionWatch())
      : line_(participant),
        operator_(gate, std::move(desk)),
        clock_(clock),
        capacity_(capacity),
        suspension_(std::move(suspension)) {}

  std::uint64_t operator_id() const override { return operator_.operator_id(); }
  OperatorWish tick(RobotTime now, const RobotStatus& status) override {
    if (suspension_.woke()) operator_.desk().stood_still();
    if (capacity_) operator_.desk().repeat_states_every(thinned({}, kControlShare, capacity_->bytes_per_s));
    line_.receive(operator_.desk(), clock_);
    OperatorWish wish = operator_.tick(std::max(now, clock_.now()), status);  // not before what was taken in
    line_.send(operator_.desk());
    taken_.add(operator_.desk().taken());
    taken_.stopped_by(operator_.desk().stopper());
    return wish;
  }

  ControlDesk& desk() { return operator_.desk(); }
  /// For any thread.
  const CommandHistory& taken() const { return taken_; }

 private:
  DeskLine line_;
  LineOperator operator_;
  const Clock& clock_;
  const LineCapacity* capacity_;
  SuspensionWatch suspension_;
  CommandHistory taken_;
};

}  // namespace foresight::link

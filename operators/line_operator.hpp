// Commands that come over the line, towards the safety gate.
#pragma once

#include <vector>

#include "link/control/control_desk.hpp"
#include "operators/commander.hpp"

namespace foresight {

/// What ControlDesk lets through becomes commands that the gate ages and judges as anybody's. A command's time is set
/// so that the gate drops it at the latest when the set-point expires, whatever becomes of this program. After each
/// loss a new session begins at the gate, which then has to see the switch open before it follows again.
class LineOperator final : public Commander {
 public:
  static constexpr std::uint64_t kId = 5;

  /// `options`: of the gate that the commands go to.
  LineOperator(const GateOptions& options, ControlDeskOptions desk);
  std::uint64_t operator_id() const override { return kId; }
  OperatorWish tick(RobotTime now, const RobotStatus& status) override;

  /// Messages go in and out here, in the thread of tick().
  ControlDesk& desk() { return desk_; }

 private:
  RobotView view(const RobotStatus& status) const;
  MotionCommand command(RobotTime now, bool deadman, const LinePositions& position);
  MotionCommand begin_session(RobotTime now, const RobotStatus& status);

  std::vector<GateJoint> joints_;
  Duration command_age_;
  ControlDesk desk_;
  CommandCounter counter_{kId};
  std::uint64_t round_ = 0;
};

}  // namespace foresight

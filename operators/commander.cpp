#include "operators/commander.hpp"

namespace foresight {

bool serve(std::span<Commander* const> commanders, Robot& robot, RobotTime now) {
  bool goes_on = true;
  const RobotStatus status = robot.status();
  for (Commander* commander : commanders) {
    const OperatorWish wish = commander->tick(now, status);
    robot.ask(wish.request, commander->operator_id());
    if (wish.command) robot.submit(*wish.command);
    goes_on = goes_on && !wish.quit;
  }
  return goes_on;
}

MotionCommand CommandCounter::command(RobotTime now, bool deadman, std::size_t joints, const JointValues& position) {
  // Its first instant: an operator that starts anew does so later.
  if (session_ == 0) session_ = static_cast<std::uint64_t>(now.ns);
  return {operator_id_, ++sequence_, now, deadman, joints, position, session_};
}

}  // namespace foresight

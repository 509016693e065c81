// Whoever commands a robot: a file, somebody at the keyboard, the line.
#pragma once

#include <optional>
#include <span>

#include "drivers/robot/robot.hpp"

namespace foresight {

/// What a commander wants at one instant.
struct OperatorWish {
  RobotRequest request = RobotRequest::none;
  std::optional<MotionCommand> command = {};
  bool quit = false;  ///< the program shall end
};

/// One operator. Pure logic, asked about every 10 ms in one thread: neither waits nor throws.
class Commander {
 public:
  virtual ~Commander() = default;
  /// Who this is, to the safety gate; not 0, and no other commander's of the same robot.
  virtual std::uint64_t operator_id() const = 0;
  /// Commands carry operator_id().
  virtual OperatorWish tick(RobotTime now, const RobotStatus& status) = 0;
};

/// Lets each of them say what it wants, in their order, and hands it to the robot. Who may do what is for the robot and
/// its gate to judge. False: one wants to quit.
bool serve(std::span<Commander* const> commanders, Robot& robot, RobotTime now);

/// Numbers and stamps one operator's commands. A new one begins a new session.
class CommandCounter {
 public:
  explicit CommandCounter(std::uint64_t operator_id) : operator_id_(operator_id) {}
  MotionCommand command(RobotTime now, bool deadman, std::size_t joints, const JointValues& position);

 private:
  std::uint64_t operator_id_, session_ = 0, sequence_ = 0;
};

}  // namespace foresight

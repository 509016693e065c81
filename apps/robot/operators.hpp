// Who commands the robot when no operator's console is connected: a file, or somebody at the keyboard.
#pragma once

#include <optional>
#include <string>

#include "apps/robot/follow_file.hpp"
#include "drivers/robot/robot.hpp"

namespace foresight {

/// What an operator wants at one instant.
struct OperatorWish {
  RobotRequest request = RobotRequest::none;
  std::optional<MotionCommand> command = {};
  bool quit = false;
};

/// Enables, homes where it may and must, goes to where the file begins, follows it, and ends. Pure logic, called about
/// every 10 ms.
class FollowOperator {
 public:
  /// `joints`: the rig's, by name.
  FollowOperator(FollowFile file, std::vector<std::string> joints, bool may_home);
  OperatorWish tick(RobotTime now, const RobotStatus& status);
  /// "done", or why not; empty while it goes on.
  const std::string& outcome() const { return outcome_; }
  bool succeeded() const { return outcome_ == "done"; }

 private:
  enum class Step { enable, home, release, approach, follow, rest };
  OperatorWish ask(RobotRequest request, Step next);
  OperatorWish command(RobotTime now, bool deadman);
  OperatorWish end(std::string outcome);
  void enter(Step step, RobotTime now);

  FollowFile file_;
  std::vector<std::string> names_;
  std::size_t joints_;
  bool may_home_;
  Step step_ = Step::enable;
  bool asked_ = false;
  RobotTime since_;
  std::uint64_t sequence_ = 0;
  JointValues target_{};
  std::string outcome_;
};

/// Hand-guiding: keys select a joint and move it as long as they repeat.
class KeyOperator {
 public:
  explicit KeyOperator(std::vector<GateJoint> joints);
  /// `keys`: all that were pressed since the last call, oldest first.
  OperatorWish tick(RobotTime now, const RobotStatus& status, const std::string& keys);
  std::size_t selected() const { return selected_; }
  bool asks_for_consent() const { return consent_; }
  static const char* help();

 private:
  RobotRequest request_for(char key);
  void jog(int direction, RobotTime now);

  std::vector<GateJoint> joints_;
  std::size_t selected_ = 0;
  int direction_ = 0;
  RobotTime jogged_, last_tick_;
  bool engaged_ = false, consent_ = false;
  std::uint64_t sequence_ = 0;
  JointValues target_{};
};

}  // namespace foresight

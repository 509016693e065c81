// Hand-guiding by single keys.
#pragma once

#include <string>
#include <vector>

#include "operators/commander.hpp"

namespace foresight {

/// Keys select a joint and move it as long as they repeat. Where they come from is for others to know.
class KeyOperator final : public Commander {
 public:
  static constexpr std::uint64_t kId = 2;
  enum class Rights {
    drives,     ///< all keys
    only_stops  ///< stop and quit: somebody else drives
  };

  explicit KeyOperator(std::vector<GateJoint> joints, Rights rights = Rights::drives);
  /// Keys for the next tick(), oldest first.
  void press(const std::string& keys) { keys_ += keys; }
  std::uint64_t operator_id() const override { return kId; }
  OperatorWish tick(RobotTime now, const RobotStatus& status) override;
  std::size_t selected() const { return selected_; }
  bool asks_for_consent() const { return consent_; }
  static const char* help();

 private:
  RobotRequest request_for(char key);
  void jog(int direction, RobotTime now);
  void press_one(char key, RobotTime now, OperatorWish& wish);
  MotionCommand command(RobotTime now, const RobotStatus& status);

  std::vector<GateJoint> joints_;
  Rights rights_;
  std::string keys_;
  std::size_t selected_ = 0;
  int direction_ = 0;
  RobotTime jogged_, last_tick_;
  bool engaged_ = false, consent_ = false;
  CommandCounter counter_{kId};
  JointValues target_{};
};

}  // namespace foresight

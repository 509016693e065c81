// Goes from place to place and lets go at each, so that somebody can look at the robot while it holds still.
#pragma once

#include <string>
#include <vector>

#include "drivers/robot/robot_words.hpp"
#include "operators/commander.hpp"
#include "operators/robot_start.hpp"

namespace foresight {

/// Enables, homes where it may and must, and waits; then follows go_to(), one station after the other. Between stations
/// the switch is released: the gate holds the robot, and whoever looks at it may take the time they need.
class StationOperator final : public Commander {
 public:
  static constexpr std::uint64_t kId = 4;

  /// `joints`: the rig's.
  StationOperator(std::vector<JointWords> joints, bool may_home);
  std::uint64_t operator_id() const override { return kId; }
  OperatorWish tick(RobotTime now, const RobotStatus& status) override;

  /// The next station; only while waiting().
  void go_to(const JointValues& positions);
  /// It holds still, with the switch released, at a station or before the first one.
  bool waiting() const { return step_ == Step::wait && still_; }
  /// Since when; only while waiting().
  RobotTime still_since() const { return still_since_; }
  /// Why the last station was not reached, in words: what the gate kept it from. "" where it was.
  const std::string& missed() const { return missed_; }
  /// Why the session cannot go on; "" while it can.
  const std::string& failure() const { return failure_; }
  void finish() { step_ = Step::done; }

 private:
  enum class Step { start, wait, engage, move, release, done };
  OperatorWish command(RobotTime now, bool deadman);
  OperatorWish fail(std::string why);
  void enter(Step step, RobotTime now);
  void watch_rest(RobotTime now, const RobotStatus& status);
  std::string reason(const RobotStatus& status) const;
  std::string kept_from(const RobotStatus& status, RobotTime now) const;

  std::vector<JointWords> joints_;
  RobotStart start_;
  Step step_ = Step::start;
  bool engaged_ = false, still_ = false;
  RobotTime since_, moved_, still_since_;
  CommandCounter counter_{kId};
  JointValues target_{}, held_{};
  std::string missed_, failure_;
};

}  // namespace foresight

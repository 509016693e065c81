// What comes over the line, to the robot that will be: RobotFuture fed by an operator's end.
//
//   /foresight/gate_motion --> RobotReport ---.
//   state of the line's control, its permit --+--> RobotFuture --> where the robot is at an instant of its clock
//   set-points as they are sent --------------'
//
// Another start of the robot's program, or a clock of its that jumped, is another robot: nothing is known of it before
// its first report.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "link/control/control_seat.hpp"
#include "link/messages/foresight_messages.hpp"
#include "prediction/robot_future.hpp"
#include "rig/rig.hpp"

namespace foresight {

/// By which the robot's clock may seem to go back before it is another one.
inline constexpr Duration kClockJump = std::chrono::milliseconds(500);

/// `commander`: ControlSeat::session(). Set-points of others have a number that none of ours has.
RobotReport robot_report(const link::GateMotion& motion, Nonce commander);

/// How good what was shown was.
struct OutlookFigures {
  std::uint64_t scored = 0;     ///< shown states whose truth came
  std::optional<double> error;  ///< of the last second: 95 % of the joints' errors are below, rad or m
  std::uint64_t refused = 0;    ///< reports and set-points that could not be used
  std::string refusal;          ///< why the last one was not
  std::uint64_t robots = 0;     ///< starts of the robot's program that were seen
};

/// One thread.
class RobotOutlook {
 public:
  /// `rig` must outlive this. Throws what RobotFuture does.
  explicit RobotOutlook(const Rig& rig);

  void hear(const link::GateMotion& motion, Nonce commander, RobotTime now);
  /// What the robot's end of the line asks for, before the reports that came with it or after; the newest one counts.
  void hear(const ControlState& state, Nonce commander);
  /// What ControlSeat::command() sent.
  void sent(const SetPoint& set_point, RobotTime now);
  /// Time has come to `now`, of the robot's clock.
  void advance(RobotTime now);

  PredictedRobot at(RobotTime time) const { return future_->at(time); }
  /// As RobotFuture::show().
  PredictedRobot show(RobotTime time) { return future_->show(time); }
  RobotTime instant_to_show(RobotTime now) { return future_->instant_to_show(now); }
  bool was_surprised(RobotTime time) const { return future_->was_surprised(time); }
  PredictedDelay delay() const { return future_->delay(); }
  const OutlookFigures& figures() const { return figures_; }
  /// A line for each joint whose drive's response was learnt: its name, and that as a key of the rig file.
  std::vector<std::string> learnt_responses() const;
  /// The newest report; nothing before the first.
  const std::optional<RobotReport>& newest() const { return newest_; }

 private:
  void begin_anew();
  void count(HistoryFault fault, const char* what);
  void score();

  const Rig& rig_;
  std::unique_ptr<RobotShape> shape_;
  std::unique_ptr<RobotFuture> future_;
  std::uint64_t session_ = 0;
  std::optional<RobotReport> newest_;
  std::optional<LinePermit> permit_;
  RobotTime now_;
  std::vector<double> errors_;  // of the last ones that were scored
  std::size_t next_error_ = 0;
  OutlookFigures figures_;
};

}  // namespace foresight

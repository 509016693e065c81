// A hand, the operator's seat, a line, and a robot with its desk, its safety gate and its drives: all of it real but
// for the drives, in stepped time.
#pragma once

#include <deque>

#include "input/hand_of_rig.hpp"
#include "input/hand_on_line.hpp"
#include "operators/line_operator.hpp"
#include "tests/robot/prompt_drive.hpp"

namespace foresight {

/// The lab's rig. Time goes in steps of 4 ms; the hand's cycle is every other one.
class HandWorld {
 public:
  explicit HandWorld(Duration delay = std::chrono::milliseconds(20));

  /// Two steps of 4 ms, with what the device says then; its `time` is set to now unless `stamped`.
  const HandCycle& cycle(const TrackerState& device, bool stamped = false);
  /// Cycles with the same state.
  const HandCycle& cycles(int count, const TrackerState& device);
  /// The program stands still while the robot and time go on.
  void stand_still(Duration time);

  OperatorTime now() const { return {now_.ns + 7'000'000'000}; }
  double cycle_seconds() const { return 0.008; }
  const std::vector<GateJoint>& joints() const { return options_.gate.joints; }
  HandControl& hand() { return *hand_; }
  const HandControl& hand() const { return *hand_; }
  std::optional<double> start(std::size_t joint) const { return options_.start[joint]; }
  Robot& robot() { return robot_; }
  GateStatus gate() const { return robot_.status().gate; }
  double shaft(std::size_t joint) const { return drives_[joint].state.position; }

  bool up_cut = false, down_cut = false;
  std::array<std::optional<double>, kMostJoints> others{};
  Pose T_base_view = Pose::Identity();

  // What was seen so far; none of these may happen.
  int steps_too_long = 0;        ///< set-points of the hand beyond velocity * time
  int moved_while_open = 0;      ///< set-points with the switch open that are not where the robot begins
  int jumps_at_press = 0;        ///< the first set-points of a press, likewise
  int shafts_moved_at_rest = 0;  ///< drives that moved though the gate neither followed nor stopped
  // And these show that something was tried.
  int driving = 0, presses = 0, following = 0;
  std::uint64_t digest = 0;  ///< of all set-points and shafts, bit by bit

 private:
  void step(bool operator_runs, const TrackerState* device, bool stamped);
  void command(const TrackerState& device, bool stamped);
  void judge(const HandRobot& robot, const HandCycle& out);
  void watch_shafts();

  Rig rig_;
  HandOptions options_;
  std::vector<PromptDrive> drives_;
  PromptNetwork network_{drives_};
  Robot robot_;
  LineOperator line_;
  ControlSeat seat_;
  std::optional<HandControl> hand_;
  Duration delay_;
  RobotTime now_{5'000'000'000};
  std::deque<std::pair<RobotTime, FromOperator>> up_;
  std::deque<std::pair<RobotTime, FromRobot>> down_;
  std::optional<JointValues> sent_;  // while the switch is held
  OperatorTime sent_at_;
  std::vector<double> shafts_;
};

/// A device that is there, its hand at `position`, with switch and clutch held or not.
TrackerState device_at(const Eigen::Vector3d& position, bool held, bool clutched);
inline TrackerState device_at(const Eigen::Vector3d& position, bool held) {
  return device_at(position, held, held);
}

}  // namespace foresight

// What a robot tells of itself and what is sent to it, as far as predicting it needs to know. Plain values.
//
// All instants are of the robot's clock; who predicts on another host converts them first (link/clocks).
#pragma once

#include <cstdint>
#include <limits>
#include <optional>

#include "common/time.hpp"
#include "motion/gate_options.hpp"

namespace foresight {

/// A set-point on its way.
struct SentSetPoint {
  std::uint64_t number = 0;  ///< from 1 on, grows strictly
  RobotTime sent;            ///< does not go back
  Duration lasts{0};         ///< from `sent` on, as long as the robot allows; then it is not executed
  bool deadman = false;      ///< the switch is held
  std::size_t joints = 0;
  JointValues position{};     ///< rad or m, in the robot's order
  std::uint64_t consent = 0;  ///< LinePermit::consent when the switch was pressed; 0: none was known
};

/// What the robot's end of a line asks for before its gate gets a switch that is held (link/control/motion_permit).
struct LinePermit {
  RobotTime time;             ///< as it was then
  std::uint64_t consent = 0;  ///< what presses have to name; another one after each loss. 0: not known
  bool let_go = false;        ///< the open switch was seen since, in time
};

struct ReportedJoint {
  RobotTime time;  ///< of `position`: when the drive told it
  double position = std::numeric_limits<double>::quiet_NaN();
  /// Of the report's cycle. The acceleration may be missing (not a number).
  JointMotion set_point;
};

/// One cycle of the robot's control loop.
struct RobotReport {
  RobotTime time;  ///< when the cycle began
  GateDoing doing = GateDoing::away;
  double speed = 1;  ///< 0 .. 1: where the gate's ramp is
  /// The newest set-point that the gate had by then, and when that came; 0: not told.
  std::uint64_t newest_set_point = 0;
  RobotTime newest_came;
  std::size_t joints = 0;
  std::array<ReportedJoint, kMostJoints> joint{};
  std::optional<LinePermit> permit;  ///< the newest that was told; nothing: none is asked for
};

/// Why something was not taken.
enum class HistoryFault : std::uint8_t {
  none,
  wrong_joint_count,
  not_finite,
  out_of_order,  ///< a number or an instant that does not grow
  other_clock,   ///< an instant far from now: of another clock, or of another day
};
const char* to_string(HistoryFault fault);

}  // namespace foresight

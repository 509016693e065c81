// Stands between every command and the drives. What leaves it can be driven.
//
//   command --> accepted? --> approach() per joint --> whole arm clear until it stands? --> set-points
//                  |                                        |
//                  no: last target holds                    no: brake()
//
// A set-point is only ever a cycle's continuation of the one before it: from each of them the robot
// can stop within all limits, clear of everything, which the gate checks before it takes the step.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "drivers/drive/drive.hpp"
#include "drivers/robot/joint_motion.hpp"
#include "drivers/robot/robot_shape.hpp"

namespace foresight {

inline constexpr std::size_t kMostJoints = 16;
using JointValues = std::array<double, kMostJoints>;

/// What an operator asks for. A plain value.
struct MotionCommand {
  std::uint64_t operator_id = 0;  ///< who; 0 is nobody
  std::uint64_t sequence = 0;     ///< grows with every command of one operator
  RobotTime time;                 ///< when it was given
  bool deadman = false;           ///< the operator holds the switch
  std::size_t joints = 0;         ///< how many positions follow; all that the rig has
  JointValues position{};         ///< rad or m, in the rig's order
};

struct GateJoint {
  std::string name;
  JointLimits limits;
  double following_error = 0.1;  ///< largest distance between set-point and feedback; > 0
  bool keeps_grip = false;       ///< a gripper: never told to release by a stop
};

struct GateOptions {
  double rate_hz = 250;
  double command_age_s = 0.1;     ///< older commands are dropped; the operator counts as lost then
  double feedback_age_s = 0.05;   ///< older feedback is frozen feedback
  double ramp_s = 2;              ///< time from a tenth to the full speed after each start
  std::vector<GateJoint> joints;  ///< 1 .. kMostJoints
  Surroundings surroundings;
  /// Throws InputError at `where`: numbers out of range, limits that contradict each other.
  void validate(const std::string& where) const;
};

enum class GateState : std::uint8_t {
  idle,       ///< nobody has engaged; set-points stay
  following,  ///< goes where the operator asks
  stopping,   ///< slows down to rest, then idle; the reason says why
  stopped,    ///< latched; needs reset()
};
const char* to_string(GateState state);

enum class GateReason : std::uint8_t {
  none,
  // a command is dropped
  not_finite,
  wrong_joint_count,
  out_of_range,
  expired,
  from_the_future,
  out_of_order,
  second_operator,
  obstructed,
  // a controlled stop
  operator_lost,
  deadman_released,
  // latched
  emergency_stop,
  following_error,
  feedback_lost,
  feedback_not_finite,
  feedback_frozen,
  drive_fault,
  drive_offline,
  drive_not_enabled,
  bus_fault,
  stands_out_of_range,
};
const char* to_string(GateReason reason);

struct GateStatus {
  GateState state = GateState::idle;
  GateReason reason = GateReason::none;     ///< of the state; while following, of what holds the robot back
  int joint = -1;                           ///< which joint the reason is about, or -1
  const char* detail = "";                  ///< more words, static or owned by the gate
  std::uint64_t operator_id = 0;            ///< who is in charge, or 0
  std::uint64_t accepted = 0, dropped = 0;  ///< commands
  GateReason last_dropped = GateReason::none;
  double speed = 0;  ///< 0 .. 1: where the ramp is
};

/// One thread: the control loop's. Nothing throws or allocates after construction.
class SafetyGate {
 public:
  /// `shape` (may be null: then nothing is checked against the surroundings) gets positions in the order of the joints.
  SafetyGate(GateOptions options, RobotShape* shape);

  /// Starts anew from where the robot stands, at rest. Only while idle or stopped and with all feedback
  /// fresh and within the limits; otherwise false, and the reason is in status(). Also ends `stopped`.
  bool reset(std::span<const DriveFeedback> feedback, RobotTime now) noexcept;

  /// Latches: brakes and stays stopped until reset(). Any state.
  void emergency_stop(const char* why) noexcept;
  /// As emergency_stop(), for what the bus reports.
  void bus_fault(const char* why) noexcept;

  /// One cycle. `command`: the newest one that arrived since the last cycle, if any. `feedback`: one per joint.
  /// Afterwards set_point(i) is what to send.
  void step(RobotTime now, const std::optional<MotionCommand>& command,
            std::span<const DriveFeedback> feedback) noexcept;

  const JointMotion& set_point(std::size_t joint) const { return motion_[joint]; }
  bool at_rest() const noexcept;
  /// The drives must be told to stop on their own too: their feedback cannot be trusted to follow set-points.
  bool wants_quick_stop() const noexcept { return quick_stop_; }
  GateStatus status() const noexcept { return status_; }
  const GateOptions& options() const { return options_; }

 private:
  GateReason judge(const MotionCommand& command, RobotTime now) noexcept;
  void take(const MotionCommand& command, RobotTime now) noexcept;
  void watch(std::span<const DriveFeedback> feedback, RobotTime now) noexcept;
  void latch(GateReason reason, int joint, const char* detail, bool quick_stop) noexcept;
  void stop(GateReason reason) noexcept;
  void move(double dt) noexcept;
  void halt(double dt) noexcept;
  const char* obstructed(const std::array<JointMotion, kMostJoints>& next, double dt) noexcept;

  GateOptions options_;
  RobotShape* shape_;
  std::size_t count_;
  GateStatus status_;
  bool quick_stop_ = false;
  std::array<JointMotion, kMostJoints> motion_{};
  JointValues target_{};
  RobotTime engaged_, last_command_;
  std::uint64_t last_operator_ = 0, last_sequence_ = 0;
  bool released_ = true;  // the deadman was seen open since the last stop
  struct Watched {
    double position = 0, set_point = 0;
    RobotTime since;
  };
  std::array<Watched, kMostJoints> watched_{};
};

}  // namespace foresight

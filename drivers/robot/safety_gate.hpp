// Stands between every command and the drives. What leaves it can be driven.
//
//   command --> accepted? --> GuardedMotion: approach() per joint --> whole arm clear until it stands? --> set-points
//                  |                                                       |
//                  no: last target holds                                   no: brake()
//
// A set-point is only ever a cycle's continuation of the one before it: from each of them the robot
// can stop within all limits, clear of everything, which the gate checks before it takes the step.
// Where it stands too close to something already, only a slow motion that takes it away from there is let through.
//
// A joint that looks for home moves by its drive's own orders, so the gate makes it no set-points; it watches it like
// all others, and whatever is wrong with any of them asks for a quick stop.
//
//   idle --engaged--> following --let go, lost--> stopping --at rest--> idle       any --> stopped: until reset()
//   idle --begin_homing()--> homing --end_homing()--> idle
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "drivers/drive/drive.hpp"
#include "drivers/robot/operator_records.hpp"
#include "motion/guarded_motion.hpp"

namespace foresight {

/// What an operator asks for. A plain value.
struct MotionCommand {
  std::uint64_t operator_id = 0;  ///< who; 0 is nobody
  std::uint64_t sequence = 0;     ///< grows with every command of one operator
  RobotTime time;                 ///< when it was given
  bool deadman = false;           ///< the operator holds the switch
  std::size_t joints = 0;         ///< how many positions follow; all that the rig has
  JointValues position{};         ///< rad or m, in the rig's order
  std::uint64_t session = 0;      ///< grows with every start of the operator, which counts `sequence` anew
  bool handed_over = false;       ///< the session begins as somebody else took over, or nobody; for words alone
};

enum class GateState : std::uint8_t {
  idle,       ///< nobody has engaged; set-points stay
  following,  ///< goes where the operator asks
  homing,     ///< one joint looks for home, all others hold
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
  handed_over,
  deadman_released,
  // latched
  not_started,  ///< since the program began
  emergency_stop,
  program_ends,
  homing_too_long,
  homed_out_of_range,
  not_enabled_in_time,
  following_error,
  feedback_lost,
  feedback_not_finite,
  feedback_frozen,
  feedback_jumps,
  drive_fault,
  drive_offline,
  drive_not_enabled,
  bus_fault,
  stands_out_of_range,
};
const char* to_string(GateReason reason);

/// What keeps the robot from where it is asked to be. It lasts until nothing has held it for a quarter of a second.
struct GateHold {
  int joint = -1;          ///< the one that has the longest way to go, in time; -1: nothing holds the robot back
  double stands = 0;       ///< its set-point, rad or m
  double asked = 0;        ///< where it is asked to be
  RobotTime since;         ///< when it was first held
  const char* parts = "";  ///< what would come too close: RobotShape::message()
  double apart = 0;        ///< distance of these parts where the robot stands, metres
  double kept_apart = 0;   ///< what must be between them
};

struct GateStatus {
  GateState state = GateState::idle;
  GateReason reason = GateReason::none;     ///< of the state; while following, of what holds the robot back
  int joint = -1;                           ///< which joint the reason is about, or -1
  const char* detail = "";                  ///< more words, static or owned by the gate
  std::uint64_t operator_id = 0;            ///< who is in charge, or 0
  std::uint64_t accepted = 0, dropped = 0;  ///< commands
  GateReason last_dropped = GateReason::none;
  double speed = 0;    ///< 0 .. 1: where the ramp is
  GateHold hold = {};  ///< only while following
};

/// One thread: the control loop's. Nothing throws or allocates after construction.
class SafetyGate {
 public:
  /// `shape` (may be null: then nothing is checked against the surroundings) gets positions in the order of the joints,
  /// and is told the surroundings.
  SafetyGate(GateOptions options, RobotShape* shape);

  /// Starts anew from where the robot stands, at rest. Only while idle or stopped and with all feedback
  /// fresh and, of drives that are homed, within the limits; otherwise false, and the reason is in status(). Also ends
  /// `stopped`. A gripper that still has a set-point keeps it: by as much as its jaws do not get there they press what
  /// they hold.
  bool reset(std::span<const DriveFeedback> feedback, RobotTime now) noexcept;

  /// Latches: brakes and stays stopped until reset(). Any state. `why`: one of the latched reasons that are not the
  /// drives' own.
  void emergency_stop(GateReason why = GateReason::emergency_stop) noexcept;
  /// As emergency_stop(), for what the bus reports.
  void bus_fault(const char* why) noexcept;
  /// While stopped: what stopped it before is gone, and this is what keeps it stopped now.
  void stay_stopped(GateReason why, int joint = -1) noexcept;

  /// Joint `joint` moves by its drive's own orders from now on, and looks for home. Only while idle; otherwise false.
  bool begin_homing(std::size_t joint, RobotTime now) noexcept;
  /// It has found it, and holds where `feedback` says. Idle again.
  void end_homing(const DriveFeedback& feedback, RobotTime now) noexcept;

  /// One cycle. `commands`: those that arrived since the last cycle, oldest first. `feedback`: one per joint.
  /// Afterwards set_point(i) is what to send, but not where has_set_point(i) says no.
  void step(RobotTime now, std::span<const MotionCommand> commands, std::span<const DriveFeedback> feedback) noexcept;

  const JointMotion& set_point(std::size_t joint) const { return motion_[joint]; }
  /// Where the operator in charge wants the joint; while following.
  double target(std::size_t joint) const { return target_[joint]; }
  /// Not before the first reset(); not of a joint from the begin of its homing until its end, or until reset() where it
  /// did not end; not of one whose set-point was forgotten, until reset().
  bool has_set_point(std::size_t joint) const noexcept { return known_[joint]; }
  /// The drive of this joint does not hold it any more.
  void forget_set_point(std::size_t joint) noexcept { known_[joint] = false; }
  /// Moves by its drive's own orders, or did until something went wrong and nobody has called reset() since.
  bool is_homing(std::size_t joint) const noexcept { return homing_ == joint; }
  /// All set-points stand still. The robot itself may still move: see RestWatch.
  bool set_points_rest() const noexcept;
  /// The drives must be told to stop on their own too: their feedback cannot be trusted to follow set-points.
  bool wants_quick_stop() const noexcept { return quick_stop_; }
  GateStatus status() const noexcept { return status_; }
  const GateOptions& options() const { return options_; }

 private:
  GateReason judge(const MotionCommand& command, const OperatorRecord& who, RobotTime now) const noexcept;
  void take(const MotionCommand& command, RobotTime now) noexcept;
  void drop(GateReason why) noexcept;
  void watch(std::span<const DriveFeedback> feedback, RobotTime now) noexcept;
  GateReason wrong_with(std::size_t joint, const DriveFeedback& f, RobotTime now) noexcept;
  GateReason wrong_while_homing(std::size_t joint, const DriveFeedback& f, RobotTime now) noexcept;
  bool keeps_grip(std::size_t joint, const DriveFeedback& feedback) const noexcept;
  void hold(std::size_t joint, double position, const DriveFeedback& feedback, RobotTime now) noexcept;
  void latch(GateReason reason, int joint, const char* detail, bool quick_stop) noexcept;
  void stop(GateReason reason) noexcept;
  void move(RobotTime now) noexcept;
  void note_hold(const GuardedMotion::Blocked& blocked, const GuardedMotion::Motions& before, RobotTime now) noexcept;

  GateOptions options_;
  RobotShape* shape_;
  std::size_t count_;
  GateStatus status_;
  bool quick_stop_ = false;
  GuardedMotion motion_;
  JointValues target_{};
  RobotTime engaged_, last_command_, held_;
  OperatorRecords operators_;
  struct Watched {
    double position = 0, set_point = 0;
    RobotTime since;  // by the gate's time
    RobotTime told;   // by the drive's
  };
  std::array<Watched, kMostJoints> watched_{};
  std::array<bool, kMostJoints> known_{};  // whether the joint has a set-point
  std::optional<std::size_t> homing_;
  int jumps_ = 0;  // of its position
};

}  // namespace foresight

// The arm, the gripper and the pan-tilt head behind the safety gate: what drives them, cycle by cycle.
//
//   disabled --enable--> enabling --> ready --home--> homing --> ready
//       ^                   |           |               |
//       +---disable---------+-- stopped <---------------+     stopped: latched, with a reason, until reset
#pragma once

#include <atomic>
#include <functional>
#include <memory>
#include <mutex>
#include <stop_token>
#include <vector>

#include "common/broadcast_ring.hpp"
#include "common/clock.hpp"
#include "common/triple_buffer.hpp"
#include "drivers/drive/drive.hpp"
#include "drivers/robot/loop_statistics.hpp"
#include "drivers/robot/safety_gate.hpp"

namespace foresight {

enum class RobotPhase : std::uint8_t { disabled, enabling, ready, homing, stopped };
const char* to_string(RobotPhase phase);

enum class RobotRequest : std::uint8_t {
  none,
  enable,   ///< from disabled: drives hold where they stand
  disable,  ///< at rest only: no torque, brakes close
  home,    ///< consent to homing: joint by joint, slowly; from ready, while nobody is in charge. No command is followed
           ///< before
  reset,   ///< from stopped, once what stopped it is gone: clears faults, enables again
  set_up,  ///< from disabled or stopped, at rest: identifies and configures all drives anew, such as one that lost its
           ///< power
  emergency_stop,  ///< any time
};

struct RobotStatus {
  RobotTime time;
  RobotPhase phase = RobotPhase::disabled;
  GateStatus gate;
  bool bus_healthy = true;
  const char* bus_reason = "";
  bool all_homed = false;
  int waiting_for = -1;      ///< enabling, homing: the joint that is not there yet
  const char* refused = "";  ///< why the last request was not followed; static text
  std::array<DriveFeedback, kMostJoints> feedback{};
  std::array<JointMotion, kMostJoints> set_point{};
  LoopStatistics loop;
};

/// A joint in one cycle.
struct JointCycle {
  RobotTime time;                                              ///< of `position`: DriveFeedback::time; 0: never
  double position = std::numeric_limits<double>::quiet_NaN();  ///< measured, at `time`; true only where homed
  double velocity = std::numeric_limits<double>::quiet_NaN();  ///< measured; the newest that the drive has told
  JointMotion set_point;                                       ///< sent in this cycle, for the next one
  DriveState drive = DriveState::offline;
  bool homed = false;
};

/// What the control loop saw and did in one cycle. A plain value.
struct RobotCycle {
  std::uint64_t number = 0;  ///< of the cycle, from 1 on; one that is missing between two was dropped
  RobotTime time;            ///< when the cycle began
  RobotPhase phase = RobotPhase::disabled;
  GateState gate = GateState::idle;
  GateReason reason = GateReason::none;
  bool all_homed = false;
  std::size_t joints = 0;  ///< how many of `joint` there are
  std::array<JointCycle, kMostJoints> joint{};
};

/// How many cycles a reader may be behind: 4 s at 250 Hz.
inline constexpr std::size_t kCyclesKept = 1024;

/// Owns the control of all drives. submit(), ask(), status() and cycles() from any thread; run() or cycle() in one.
class Robot {
 public:
  /// `drives`: in the order of the gate's joints, all of them in one of the `networks`, identified and configured. All
  /// outlive the robot.
  Robot(GateOptions options, RobotShape* shape, std::vector<DriveNetwork*> networks, std::vector<Drive*> drives);

  /// The newest command wins; one that is replaced before a cycle saw it is never followed.
  void submit(const MotionCommand& command);
  /// Followed in the next cycle if the phase allows; status().refused says why not.
  void ask(RobotRequest request) noexcept;
  RobotStatus status() const;
  /// Hands out every cycle from now on, to any number of readers, of which each is for one thread. The loop never
  /// waits for them: who falls behind by more than kCyclesKept misses the oldest, and counts them.
  BroadcastRing<RobotCycle>::Reader cycles() const noexcept { return cycles_.reader(); }

  /// One cycle at `now`. Does not allocate, block or throw.
  void cycle(RobotTime now) noexcept;

  /// Cycles at absolute deadlines until `stop`, then shuts down: stops under control, closes the brakes. In
  /// real time or in stepped time.
  /// `set_up` follows RobotRequest::set_up between two cycles; it may block, throws nothing, and leaves all drives
  /// disabled.
  void run(Clock& clock, std::stop_token stop, const std::function<void()>& set_up = {}) noexcept;

 private:
  void follow_request(RobotRequest request, RobotTime now) noexcept;
  void advance_enabling(RobotTime now) noexcept;
  void advance_homing(RobotTime now) noexcept;
  void enter(RobotPhase phase, RobotTime now) noexcept;
  void stop_all() noexcept;
  void publish(RobotTime now) noexcept;
  void hand_out(const RobotStatus& status) noexcept;
  void shut_down(Clock& clock, RobotTime due) noexcept;
  void disable_all() noexcept;
  bool all_disabled() const noexcept;
  bool all_homed() const noexcept;

  SafetyGate gate_;
  std::vector<DriveNetwork*> networks_;
  std::vector<Drive*> drives_;
  std::vector<DriveFeedback> feedback_;
  RobotPhase phase_ = RobotPhase::disabled;
  RobotTime phase_since_;
  std::size_t homing_ = 0;
  bool homing_asked_ = false;
  bool set_up_asked_ = false;
  std::array<bool, kMostJoints> reset_asked_{};  // since enabling began
  RobotTime ask_again_;
  const char* refused_ = "";
  int waiting_for_ = -1;
  LoopStatistics loop_;

  std::mutex writers_;  // of commands; the loop never takes it
  TripleBuffer<MotionCommand> commands_;
  std::atomic<RobotRequest> request_{RobotRequest::none};
  std::atomic<bool> stop_asked_{false};
  std::uint64_t cycle_number_ = 0;
  BroadcastRing<RobotCycle> cycles_{kCyclesKept};
  mutable std::mutex readers_;  // of statuses
  mutable TripleBuffer<RobotStatus> published_;
  mutable RobotStatus last_;
};

}  // namespace foresight

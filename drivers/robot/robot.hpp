// The arm, the gripper and the pan-tilt head behind the safety gate: what drives them, cycle by cycle.
//
//   disabled --enable--> enabling --> ready --home--> homing --> ready
//     ^ ^ |                 |           |               |
//     | +-|----disable------+-- stopped <---------------+     stopped: latched, with a reason, until reset
//     |   |                        |
//     |   +--set up--> setting_up <-+
//     +--------------------+
//
// The gate watches all drives while one homes as it does in any other motion. "At rest" means that set-points and
// measured positions stand still (RestWatch): no torque is taken away before.
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
#include "drivers/robot/rest_watch.hpp"
#include "drivers/robot/safety_gate.hpp"

namespace foresight {

enum class RobotPhase : std::uint8_t {
  disabled,
  enabling,
  ready,
  homing,
  stopped,
  setting_up,  ///< drives are configured anew; no cycles meanwhile
};
const char* to_string(RobotPhase phase);

enum class RobotRequest : std::uint8_t {
  none,
  enable,   ///< from disabled: drives hold where they stand
  disable,  ///< at rest only: no torque, brakes close
  home,    ///< consent to homing of the joints that need it: one by one, slowly; from ready, while nobody is in charge.
           ///< No command is followed before. Refused where all are homed
  reset,   ///< from stopped, once what stopped it is gone: clears faults, enables again
  set_up,  ///< from disabled or stopped, at rest: identifies and configures all drives anew, such as one that lost its
           ///< power
  emergency_stop,  ///< any time
};

/// A request, and who made it.
struct AskedRequest {
  RobotRequest what = RobotRequest::none;
  std::uint64_t operator_id = 0;  ///< 0: nobody in particular
};

struct RobotStatus {
  RobotTime time;
  RobotPhase phase = RobotPhase::disabled;
  GateStatus gate;
  bool bus_healthy = true;
  const char* bus_reason = "";
  bool all_homed = false;
  int waiting_for = -1;       ///< enabling, homing: the joint that is not there yet
  Duration stood_still{};     ///< stopped: for so long no cycle came just before; 0: they came
  AskedRequest last_request;  ///< that was taken up, followed or not
  const char* refused = "";   ///< why it was not followed; static text
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
  double asked = std::numeric_limits<double>::quiet_NaN();     ///< where the operator wants it; only while following
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
  int reason_joint = -1;    ///< GateStatus::joint
  const char* detail = "";  ///< GateStatus::detail
  GateHold hold;
  bool all_homed = false;
  std::size_t joints = 0;  ///< how many of `joint` there are
  std::array<JointCycle, kMostJoints> joint{};
};

/// For who predicts it.
GateDoing doing_of(RobotPhase phase, GateState gate) noexcept;

inline constexpr std::size_t kCommandsKept = 64, kRequestsKept = 64;
/// How many cycles a reader may be behind: 4 s at 250 Hz.
inline constexpr std::size_t kCyclesKept = 1024;

/// Owns the control of all drives. submit(), ask(), status() and cycles() from any thread; run() or cycle() in one.
class Robot {
 public:
  /// `drives`: in the order of the gate's joints, all of them in one of the `networks`, identified and configured. All
  /// outlive the robot.
  Robot(GateOptions options, RobotShape* shape, std::vector<DriveNetwork*> networks, std::vector<Drive*> drives);

  /// Judged in the next cycle, those of all operators in the order in which they came: so of one operator's, the
  /// newest wins. More than kCommandsKept between two cycles: the oldest go.
  void submit(const MotionCommand& command);
  /// Requests are followed in the order in which they came, one a cycle, each if the phase allows it then;
  /// status().refused says why not. Before all of them goes an emergency stop: it counts in the next cycle, and what
  /// was asked for before that cycle is dropped, whether it came before the stop or after. So nothing that was asked
  /// for without having seen the stop can undo it.
  void ask(RobotRequest request, std::uint64_t operator_id = 0) noexcept;
  RobotStatus status() const;
  /// Hands out every cycle from now on, to any number of readers, of which each is for one thread. The loop never
  /// waits for them: who falls behind by more than kCyclesKept misses the oldest, and counts them.
  BroadcastRing<RobotCycle>::Reader cycles() const noexcept { return cycles_.reader(); }

  /// One cycle at `now`. Does not allocate, block or throw.
  void cycle(RobotTime now) noexcept;

  /// Cycles at absolute deadlines until `stop`, then shuts down: stops under control, closes the brakes. In
  /// real time or in stepped time.
  /// `set_up` follows RobotRequest::set_up between two cycles, in phase setting_up; it may block, throws nothing, and
  /// leaves all drives disabled.
  void run(Clock& clock, std::stop_token stop, const std::function<void()>& set_up = {}) noexcept;

 private:
  std::size_t take_commands() noexcept;
  void take_requests(RobotTime now) noexcept;
  void follow(RobotRequest request, RobotTime now) noexcept;
  void let_gate_step(RobotTime now) noexcept;
  void forget_set_points() noexcept;
  void advance_enabling(RobotTime now) noexcept;
  void advance_homing(RobotTime now) noexcept;
  /// The first from `from` on that does not know where it is; as many as there are drives: none.
  std::size_t next_to_home(std::size_t from) const noexcept;
  Duration home_within(std::size_t joint) const noexcept;
  void note_standstill(RobotTime now) noexcept;
  void enter(RobotPhase phase, RobotTime now, int waiting_for = -1) noexcept;
  bool at_rest() const noexcept;
  void stop_all() noexcept;
  void publish(RobotTime now) noexcept;
  void hand_out(const RobotStatus& status) noexcept;
  void shut_down(Clock& clock, RobotTime due) noexcept;
  void disable_all() noexcept;
  bool all_disabled() const noexcept;
  bool all_homed() const noexcept;

  SafetyGate gate_;
  RestWatch rest_;
  std::vector<DriveNetwork*> networks_;
  std::vector<Drive*> drives_;
  std::vector<DriveFeedback> feedback_;
  RobotPhase phase_ = RobotPhase::disabled;
  RobotTime phase_since_;
  RobotTime last_cycle_;  // 0: there is none to compare with
  Duration stood_still_{};
  RobotTime went_on_;  // after stood_still_
  std::size_t homing_ = 0;
  bool homing_asked_ = false;
  bool set_up_asked_ = false;
  bool told_to_stop_ = false;  // the drives, for what the gate has latched
  bool ending_ = false;
  std::array<bool, kMostJoints> reset_asked_{};  // since enabling began
  RobotTime ask_again_;
  AskedRequest last_request_;
  const char* refused_ = "";
  int waiting_for_ = -1;
  LoopStatistics loop_;

  std::mutex writers_;  // of commands and requests; the loop never takes it
  BroadcastRing<MotionCommand> commands_{kCommandsKept};
  BroadcastRing<MotionCommand>::Reader new_commands_ = commands_.reader();
  BroadcastRing<AskedRequest> requests_{kRequestsKept};
  BroadcastRing<AskedRequest>::Reader new_requests_ = requests_.reader();
  std::array<MotionCommand, kCommandsKept> taken_{};
  std::atomic<bool> stop_asked_{false};
  std::atomic<std::uint64_t> stop_asked_by_{0};
  std::uint64_t cycle_number_ = 0;
  BroadcastRing<RobotCycle> cycles_{kCyclesKept};
  mutable std::mutex readers_;  // of statuses
  mutable TripleBuffer<RobotStatus> published_;
  mutable RobotStatus last_;
};

}  // namespace foresight

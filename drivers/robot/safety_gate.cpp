#include "drivers/robot/safety_gate.hpp"

#include <algorithm>
#include <cmath>

namespace foresight {
namespace {

constexpr double kFrozenAfter = 0.25;  // seconds without any change of a position that should change
constexpr double kFrozenWay = 0.25;    // share of the following error that the set-point moved meanwhile
constexpr double kHeldFor = 0.25;      // seconds: one who is held, brakes and tries again is held all the while
// A drive that homes opens its brake first, and rests for a moment where it turns round at its switch.
constexpr double kHomingFrozenAfter = 1;  // seconds
constexpr int kHomingJumps = 1;           // where it sets its zero

}  // namespace

SafetyGate::SafetyGate(GateOptions options, RobotShape* shape)
    : options_(std::move(options)), shape_(shape), count_(options_.joints.size()), motion_(options_, shape) {
  latch(GateReason::not_started, -1, "", false);
}

bool SafetyGate::reset(std::span<const DriveFeedback> feedback, RobotTime now) noexcept {
  if ((status_.state != GateState::idle && status_.state != GateState::stopped) || feedback.size() != count_)
    return false;
  for (std::size_t i = 0; i < count_; ++i) {
    const JointLimits& limits = options_.joints[i].limits;
    const double position = feedback[i].position;
    const bool fresh = feedback[i].time.ns != 0 && now - feedback[i].time <= seconds(options_.feedback_age_s);
    // Before it is homed, a drive counts from anywhere: only looking for home tells where the joint stands.
    const bool within = position >= limits.min_position && position <= limits.max_position;
    if (fresh && (within || (!feedback[i].homed && std::isfinite(position)))) continue;
    status_.reason = !fresh                     ? GateReason::feedback_lost
                     : !std::isfinite(position) ? GateReason::feedback_not_finite
                                                : GateReason::stands_out_of_range;
    status_.joint = static_cast<int>(i);
    return false;
  }
  for (std::size_t i = 0; i < count_; ++i)
    hold(i, keeps_grip(i, feedback[i]) ? motion_[i].position : feedback[i].position, feedback[i], now);
  status_.state = GateState::idle;
  status_.reason = GateReason::none;
  status_.joint = -1;
  status_.detail = "";
  status_.operator_id = 0;
  status_.speed = 0;
  quick_stop_ = false;
  homing_.reset();
  operators_.forget_released();
  return true;
}

/// Its jaws press something, or may: they do not get to their set-point, but nearly.
bool SafetyGate::keeps_grip(std::size_t joint, const DriveFeedback& feedback) const noexcept {
  const GateJoint& options = options_.joints[joint];
  return options.keeps_grip && known_[joint] &&
         std::abs(feedback.position - motion_[joint].position) <= options.following_error;
}

/// At rest from now on.
void SafetyGate::hold(std::size_t joint, double position, const DriveFeedback& feedback, RobotTime now) noexcept {
  motion_.set(joint, {position, 0, 0});
  known_[joint] = true;
  target_[joint] = position;
  watched_[joint] = {feedback.position, position, now, feedback.time};
}

bool SafetyGate::begin_homing(std::size_t joint, RobotTime now) noexcept {
  if (status_.state != GateState::idle || joint >= count_) return false;
  status_.state = GateState::homing;
  status_.reason = GateReason::none;
  status_.joint = -1;
  status_.detail = "";
  homing_ = joint;
  known_[joint] = false;
  jumps_ = 0;
  watched_[joint].since = now;
  operators_.forget_released();
  return true;
}

void SafetyGate::end_homing(const DriveFeedback& feedback, RobotTime now) noexcept {
  if (status_.state != GateState::homing) return;
  hold(*homing_, feedback.position, feedback, now);
  homing_.reset();
  status_.state = GateState::idle;
}

void SafetyGate::emergency_stop(GateReason why) noexcept {
  latch(why, -1, "", false);
}
void SafetyGate::bus_fault(const char* why) noexcept {
  latch(GateReason::bus_fault, -1, why, true);
}

void SafetyGate::stay_stopped(GateReason why, int joint) noexcept {
  if (status_.state != GateState::stopped) return;
  status_.reason = why;
  status_.joint = joint;
  status_.detail = "";
}

void SafetyGate::latch(GateReason reason, int joint, const char* detail, bool quick_stop) noexcept {
  // No set-point slows down a joint that looks for home: only its drive can.
  quick_stop_ = quick_stop_ || quick_stop || status_.state == GateState::homing;
  if (status_.state == GateState::stopped) return;  // the first reason is the one that helps
  status_.state = GateState::stopped;
  status_.reason = reason;
  status_.joint = joint;
  status_.detail = detail;
  status_.operator_id = 0;
}

void SafetyGate::stop(GateReason reason) noexcept {
  status_.state = GateState::stopping;
  status_.reason = reason;
  status_.joint = -1;
  status_.detail = "";
  operators_.of(status_.operator_id, status_.operator_id).released = reason == GateReason::deadman_released;
}

GateReason SafetyGate::judge(const MotionCommand& command, const OperatorRecord& who, RobotTime now) const noexcept {
  if (command.joints != count_) return GateReason::wrong_joint_count;
  const std::int64_t most = seconds(options_.command_age_s).count();
  if (command.time.ns < now.ns - most) return GateReason::expired;
  if (command.time.ns > now.ns + most) return GateReason::from_the_future;
  if (command.session < who.session || (command.session == who.session && command.sequence <= who.sequence))
    return GateReason::out_of_order;
  for (std::size_t i = 0; i < count_; ++i) {
    if (!std::isfinite(command.position[i])) return GateReason::not_finite;
    if (!options_.joints[i].reaches(command.position[i])) return GateReason::out_of_range;
  }
  return GateReason::none;
}

void SafetyGate::drop(GateReason why) noexcept {
  ++status_.dropped;
  status_.last_dropped = why;
}

void SafetyGate::take(const MotionCommand& command, RobotTime now) noexcept {
  if (status_.state != GateState::stopped) status_.joint = -1;
  if (command.operator_id == 0) return drop(GateReason::second_operator);
  OperatorRecord& who = operators_.of(command.operator_id, status_.operator_id);
  if (const GateReason wrong = judge(command, who, now); wrong != GateReason::none) return drop(wrong);
  const bool in_charge = status_.operator_id == command.operator_id;
  if (command.session != who.session) {
    // Started anew: what it held before, it does not hold now.
    who.released = false;
    if (in_charge && status_.state == GateState::following)
      stop(command.handed_over ? GateReason::handed_over : GateReason::operator_lost);
  }
  who.session = command.session;
  who.sequence = command.sequence;
  if (status_.operator_id != 0 && !in_charge) {
    // Whoever presses the switch while another one is in charge must let go of it before taking over.
    who.released = !command.deadman;
    return drop(GateReason::second_operator);
  }
  ++status_.accepted;
  if (!command.deadman) {
    who.released = true;
    if (status_.state == GateState::following) stop(GateReason::deadman_released);
    return;
  }
  if (status_.state == GateState::idle && who.released) {
    status_.state = GateState::following;
    status_.reason = GateReason::none;
    status_.operator_id = command.operator_id;
    engaged_ = now;
  }
  if (status_.state != GateState::following) return;
  last_command_ = command.time;
  std::copy_n(command.position.begin(), count_, target_.begin());
}

// A robot that stands is not watched but for faults: it is enabled and disabled, and moved by hand.
void SafetyGate::watch(std::span<const DriveFeedback> feedback, RobotTime now) noexcept {
  if (status_.state == GateState::stopped && quick_stop_) return;
  const bool moving = status_.state == GateState::stopped ? !set_points_rest() : status_.state != GateState::idle;
  for (std::size_t i = 0; i < count_; ++i) {
    const DriveFeedback& f = feedback[i];
    const auto joint = static_cast<int>(i);
    if (f.state == DriveState::fault) return latch(GateReason::drive_fault, joint, f.fault, true);
    if (!moving) continue;
    const GateReason wrong = wrong_with(i, f, now);
    const char* detail = wrong == GateReason::drive_not_enabled ? foresight::to_string(f.state) : "";
    if (wrong != GateReason::none) return latch(wrong, joint, detail, true);
  }
}

GateReason SafetyGate::wrong_with(std::size_t joint, const DriveFeedback& f, RobotTime now) noexcept {
  if (f.state == DriveState::offline) return GateReason::drive_offline;
  const bool homing = homing_ == joint;
  // Before and after, it takes the drive some cycles to change its mode.
  const bool may_home = homing && (f.state == DriveState::homing || f.state == DriveState::enabling);
  if (f.state != DriveState::enabled && !may_home) return GateReason::drive_not_enabled;
  if (f.time.ns == 0 || now - f.time > seconds(options_.feedback_age_s)) return GateReason::feedback_lost;
  if (!std::isfinite(f.position)) return GateReason::feedback_not_finite;
  if (homing) return wrong_while_homing(joint, f, now);
  const double allowed = options_.joints[joint].following_error;
  if (std::abs(f.position - motion_[joint].position) > allowed) return GateReason::following_error;
  Watched& w = watched_[joint];
  if (f.position != w.position) {
    w = {f.position, motion_[joint].position, now, f.time};
  } else if (!options_.joints[joint].keeps_grip &&  // jaws stand where they meet something
             now - w.since > seconds(kFrozenAfter) &&
             std::abs(motion_[joint].position - w.set_point) > kFrozenWay * allowed) {
    return GateReason::feedback_frozen;
  }
  return GateReason::none;
}

// Where it is, nobody knows yet; but it moves, steadily, and once gets a new zero.
GateReason SafetyGate::wrong_while_homing(std::size_t joint, const DriveFeedback& f, RobotTime now) noexcept {
  Watched& w = watched_[joint];
  const double cycle = 1 / options_.rate_hz;
  const double most = options_.joints[joint].limits.velocity * (to_seconds(f.time - w.told) + cycle);
  if (std::abs(f.position - w.position) > most && ++jumps_ > kHomingJumps) return GateReason::feedback_jumps;
  if (f.position != w.position || f.state != DriveState::homing)
    w.since = now;
  else if (now - w.since > seconds(kHomingFrozenAfter))
    return GateReason::feedback_frozen;
  w.position = f.position;
  w.told = f.time;
  return GateReason::none;
}

/// `blocked` keeps the robot from going on from `before`.
void SafetyGate::note_hold(const GuardedMotion::Blocked& blocked, const GuardedMotion::Motions& before,
                           RobotTime now) noexcept {
  GateHold& hold = status_.hold;
  if (hold.joint < 0) hold.since = now;
  held_ = now;
  hold.parts = shape_->message(blocked.couple);
  hold.kept_apart = shape_->kept_apart(blocked.couple);
  hold.apart = blocked.margin + hold.kept_apart;
  double longest = -1;
  for (std::size_t i = 0; i < count_; ++i) {
    const double time = std::abs(target_[i] - before[i].position) / options_.joints[i].limits.velocity;
    if (time <= longest) continue;
    longest = time;
    hold.joint = static_cast<int>(i);
    hold.stands = before[i].position;
    hold.asked = target_[i];
  }
}

void SafetyGate::move(RobotTime now) noexcept {
  const GuardedMotion::Motions before = motion_.all();
  const auto blocked = motion_.go_towards(target_, status_.speed);
  status_.reason = blocked ? GateReason::obstructed : GateReason::none;
  status_.detail = blocked ? shape_->message(blocked->couple) : "";
  if (blocked)
    note_hold(*blocked, before, now);
  else if (now - held_ > seconds(kHeldFor))
    status_.hold = {};
}

void SafetyGate::step(RobotTime now, std::span<const MotionCommand> commands,
                      std::span<const DriveFeedback> feedback) noexcept {
  if (feedback.size() != count_) return latch(GateReason::feedback_lost, -1, "feedback of too few joints", true);
  watch(feedback, now);
  const bool followed = status_.state == GateState::following;
  for (const MotionCommand& command : commands) take(command, now);
  // A robot that stood may have lost its torque unseen: it is watched before the first step.
  if (status_.state == GateState::following && !followed) watch(feedback, now);
  if (status_.state == GateState::following && now - last_command_ > seconds(options_.command_age_s))
    stop(GateReason::operator_lost);
  if (status_.state == GateState::following) {
    status_.speed = options_.speed_after(now - engaged_);
    move(now);
    return;
  }
  status_.hold = {};
  motion_.halt();
  if (status_.state == GateState::stopping && set_points_rest()) {
    status_.state = GateState::idle;
    status_.operator_id = 0;
    status_.speed = 0;
  }
}

bool SafetyGate::set_points_rest() const noexcept {
  return motion_.at_rest();
}

}  // namespace foresight

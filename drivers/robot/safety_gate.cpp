#include "drivers/robot/safety_gate.hpp"

#include <algorithm>
#include <cmath>

namespace foresight {
namespace {

constexpr double kFirstSpeed = 0.1;    // of the ramp
constexpr double kFrozenAfter = 0.25;  // seconds without any change of a position that should change
constexpr double kFrozenWay = 0.25;    // share of the following error that the set-point moved meanwhile
constexpr int kSamplesToRest = 4;      // poses checked on the way to where the robot would stop

}  // namespace

SafetyGate::SafetyGate(GateOptions options, RobotShape* shape)
    : options_(std::move(options)), shape_(shape), count_(options_.joints.size()) {
  options_.validate("safety gate");
  latch(GateReason::emergency_stop, -1, "not started yet", false);
}

bool SafetyGate::reset(std::span<const DriveFeedback> feedback, RobotTime now) noexcept {
  if (status_.state == GateState::following || status_.state == GateState::stopping || feedback.size() != count_)
    return false;
  for (std::size_t i = 0; i < count_; ++i) {
    const JointLimits& limits = options_.joints[i].limits;
    const double position = feedback[i].position;
    const bool fresh = feedback[i].time.ns != 0 && now - feedback[i].time <= seconds(options_.feedback_age_s);
    if (fresh && position >= limits.min_position && position <= limits.max_position) continue;
    status_.reason = !fresh                     ? GateReason::feedback_lost
                     : !std::isfinite(position) ? GateReason::feedback_not_finite
                                                : GateReason::stands_out_of_range;
    status_.joint = static_cast<int>(i);
    return false;
  }
  for (std::size_t i = 0; i < count_; ++i) {
    motion_[i] = {feedback[i].position, 0, 0};
    target_[i] = feedback[i].position;
    watched_[i] = {feedback[i].position, feedback[i].position, now};
  }
  status_.state = GateState::idle;
  status_.reason = GateReason::none;
  status_.joint = -1;
  status_.detail = "";
  status_.operator_id = 0;
  status_.speed = 0;
  quick_stop_ = false;
  released_ = false;
  return true;
}

void SafetyGate::emergency_stop(const char* why) noexcept {
  latch(GateReason::emergency_stop, -1, why, false);
}
void SafetyGate::bus_fault(const char* why) noexcept {
  latch(GateReason::bus_fault, -1, why, true);
}

void SafetyGate::latch(GateReason reason, int joint, const char* detail, bool quick_stop) noexcept {
  quick_stop_ = quick_stop_ || quick_stop;
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
  released_ = reason == GateReason::deadman_released;
}

GateReason SafetyGate::judge(const MotionCommand& command, RobotTime now) noexcept {
  status_.joint = status_.state == GateState::stopped ? status_.joint : -1;
  if (command.joints != count_) return GateReason::wrong_joint_count;
  const std::int64_t most = seconds(options_.command_age_s).count();
  if (command.time.ns < now.ns - most) return GateReason::expired;
  if (command.time.ns > now.ns + most) return GateReason::from_the_future;
  if (command.operator_id == 0 || (status_.operator_id != 0 && command.operator_id != status_.operator_id))
    return GateReason::second_operator;
  if (command.operator_id == last_operator_ && command.sequence <= last_sequence_) return GateReason::out_of_order;
  for (std::size_t i = 0; i < count_; ++i) {
    const JointLimits& limits = options_.joints[i].limits;
    // A little beyond, as rounding makes it, means the limit.
    constexpr double kRounding = 1e-6;
    if (!std::isfinite(command.position[i])) return GateReason::not_finite;
    if (command.position[i] < limits.min_position - kRounding || command.position[i] > limits.max_position + kRounding)
      return GateReason::out_of_range;
  }
  return GateReason::none;
}

void SafetyGate::take(const MotionCommand& command, RobotTime now) noexcept {
  const GateReason wrong = judge(command, now);
  if (wrong != GateReason::none) {
    ++status_.dropped;
    status_.last_dropped = wrong;
    return;
  }
  ++status_.accepted;
  last_operator_ = command.operator_id;
  last_sequence_ = command.sequence;
  last_command_ = command.time;
  if (!command.deadman) {
    released_ = true;
    if (status_.state == GateState::following) stop(GateReason::deadman_released);
    return;
  }
  if (status_.state == GateState::idle && released_) {
    status_.state = GateState::following;
    status_.reason = GateReason::none;
    status_.operator_id = command.operator_id;
    engaged_ = now;
  }
  if (status_.state == GateState::following) std::copy_n(command.position.begin(), count_, target_.begin());
}

void SafetyGate::watch(std::span<const DriveFeedback> feedback, RobotTime now) noexcept {
  if (status_.state == GateState::stopped && quick_stop_) return;
  const bool moving = status_.state == GateState::following || status_.state == GateState::stopping;
  for (std::size_t i = 0; i < count_; ++i) {
    const DriveFeedback& f = feedback[i];
    const auto joint = static_cast<int>(i);
    if (f.state == DriveState::fault) return latch(GateReason::drive_fault, joint, f.fault, true);
    if (!moving) continue;
    if (f.state == DriveState::offline) return latch(GateReason::drive_offline, joint, "", true);
    if (f.state != DriveState::enabled)
      return latch(GateReason::drive_not_enabled, joint, foresight::to_string(f.state), true);
    if (f.time.ns == 0 || now - f.time > seconds(options_.feedback_age_s))
      return latch(GateReason::feedback_lost, joint, "", true);
    if (!std::isfinite(f.position)) return latch(GateReason::feedback_not_finite, joint, "", true);
    if (std::abs(f.position - motion_[i].position) > options_.joints[i].following_error)
      return latch(GateReason::following_error, joint, "", true);
    Watched& w = watched_[i];
    if (f.position != w.position) {
      w = {f.position, motion_[i].position, now};
    } else if (now - w.since > seconds(kFrozenAfter) &&
               std::abs(motion_[i].position - w.set_point) > kFrozenWay * options_.joints[i].following_error) {
      return latch(GateReason::feedback_frozen, joint, "", true);
    }
  }
}

const char* SafetyGate::obstructed(const std::array<JointMotion, kMostJoints>& next, double dt) noexcept {
  if (shape_ == nullptr) return nullptr;
  JointValues here{}, rest{}, between{};
  for (std::size_t i = 0; i < count_; ++i) {
    here[i] = next[i].position;
    rest[i] = stop_position(next[i], options_.joints[i].limits, dt);
  }
  for (int k = 0; k <= kSamplesToRest; ++k) {
    const double share = static_cast<double>(k) / kSamplesToRest;
    for (std::size_t i = 0; i < count_; ++i) between[i] = here[i] + share * (rest[i] - here[i]);
    if (const char* what = shape_->obstructed({between.data(), count_}, options_.surroundings)) return what;
  }
  return nullptr;
}

void SafetyGate::halt(double dt) noexcept {
  for (std::size_t i = 0; i < count_; ++i) motion_[i] = brake(motion_[i], options_.joints[i].limits, dt);
}

void SafetyGate::move(double dt) noexcept {
  auto next = motion_;
  for (std::size_t i = 0; i < count_; ++i)
    next[i] = approach(motion_[i], target_[i], options_.joints[i].limits, status_.speed, dt);
  const char* what = obstructed(next, dt);
  status_.reason = what != nullptr ? GateReason::obstructed : GateReason::none;
  status_.detail = what != nullptr ? what : "";
  if (what != nullptr)
    halt(dt);
  else
    motion_ = next;
}

void SafetyGate::step(RobotTime now, const std::optional<MotionCommand>& command,
                      std::span<const DriveFeedback> feedback) noexcept {
  const double dt = 1 / options_.rate_hz;
  if (feedback.size() != count_) return latch(GateReason::feedback_lost, -1, "feedback of too few joints", true);
  watch(feedback, now);
  if (command) take(*command, now);
  if (status_.state == GateState::following && now - last_command_ > seconds(options_.command_age_s))
    stop(GateReason::operator_lost);
  if (status_.state == GateState::following) {
    const double ramped = options_.ramp_s > 0 ? to_seconds(now - engaged_) / options_.ramp_s : 1;
    status_.speed = std::clamp(kFirstSpeed + (1 - kFirstSpeed) * ramped, kFirstSpeed, 1.0);
    move(dt);
    return;
  }
  halt(dt);
  if (status_.state == GateState::stopping && at_rest()) {
    status_.state = GateState::idle;
    status_.operator_id = 0;
    status_.speed = 0;
  }
}

bool SafetyGate::at_rest() const noexcept {
  return std::all_of(motion_.begin(), motion_.begin() + static_cast<std::ptrdiff_t>(count_),
                     [](const JointMotion& m) { return m.velocity == 0 && m.acceleration == 0; });
}

}  // namespace foresight

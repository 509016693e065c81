#include "drivers/robot/safety_gate.hpp"

#include <algorithm>
#include <cmath>

#include "common/error.hpp"

namespace foresight {
namespace {

constexpr double kFirstSpeed = 0.1;    // of the ramp
constexpr double kFrozenAfter = 0.25;  // seconds without any change of a position that should change
constexpr double kFrozenWay = 0.25;    // share of the following error that the set-point moved meanwhile
constexpr int kSamplesToRest = 4;      // poses checked on the way to where the robot would stop

void require(bool ok, const std::string& where, const std::string& what, const std::string& cure) {
  if (!ok) throw InputError(where, what, cure);
}

}  // namespace

const char* to_string(GateState state) {
  switch (state) {
    case GateState::idle: return "idle";
    case GateState::following: return "following";
    case GateState::stopping: return "stopping";
    case GateState::stopped: return "stopped";
  }
  return "?";
}

const char* to_string(GateReason reason) {
  switch (reason) {
    case GateReason::none: return "";
    case GateReason::not_finite: return "a commanded position is not a number";
    case GateReason::wrong_joint_count: return "a command for another number of joints";
    case GateReason::out_of_range: return "a commanded position is beyond the joint's limits";
    case GateReason::expired: return "a command came too late";
    case GateReason::from_the_future: return "a command is stamped in the future";
    case GateReason::out_of_order: return "a command is older than one before it";
    case GateReason::second_operator: return "another operator is in charge";
    case GateReason::obstructed: return "the way is obstructed";
    case GateReason::operator_lost: return "no command in time: the operator is lost";
    case GateReason::deadman_released: return "the deadman switch was released";
    case GateReason::emergency_stop: return "emergency stop";
    case GateReason::following_error: return "the joint does not follow its set-points";
    case GateReason::stands_out_of_range:
      return "the joint stands beyond its limits; move it back by hand, or correct them";
    case GateReason::feedback_lost: return "no position from the drive in time";
    case GateReason::feedback_not_finite: return "the drive's position is not a number";
    case GateReason::feedback_frozen: return "the drive's position does not change while it should";
    case GateReason::drive_fault: return "the drive reports a fault";
    case GateReason::drive_offline: return "the drive does not answer";
    case GateReason::drive_not_enabled: return "the drive is no longer enabled";
    case GateReason::bus_fault: return "the bus is not usable";
  }
  return "?";
}

void GateOptions::validate(const std::string& where) const {
  require(rate_hz >= 10 && rate_hz <= 2000, where, "rate_hz is " + std::to_string(rate_hz), "choose from 10 to 2000");
  require(command_age_s > 1 / rate_hz && command_age_s <= 2, where, "command_age_s is " + std::to_string(command_age_s),
          "choose more than one cycle, and at most 2");
  require(feedback_age_s > 1 / rate_hz && feedback_age_s <= 1, where,
          "feedback_age_s is " + std::to_string(feedback_age_s), "choose more than one cycle, and at most 1");
  require(ramp_s >= 0 && ramp_s <= 60, where, "ramp_s is " + std::to_string(ramp_s), "choose from 0 to 60");
  require(!joints.empty() && joints.size() <= kMostJoints, where, std::to_string(joints.size()) + " joints",
          "give 1 to " + std::to_string(kMostJoints));
  for (const GateJoint& joint : joints) {
    const std::string at = where + ": joint '" + joint.name + "'";
    const JointLimits& l = joint.limits;
    require(std::isfinite(l.min_position) && std::isfinite(l.max_position) && l.min_position < l.max_position, at,
            "the least position " + std::to_string(l.min_position) + " is not below the largest, " +
                std::to_string(l.max_position),
            "exchange or correct them");
    for (const auto& [name, value] : {std::pair("velocity", l.velocity),
                                      {"acceleration", l.acceleration},
                                      {"jerk", l.jerk},
                                      {"following error", joint.following_error}})
      require(std::isfinite(value) && value > 0, at,
              "its largest " + std::string(name) + " is " + std::to_string(value), "give a number above 0");
    require(l.velocity / rate_hz < joint.following_error, at,
            "in one cycle it moves " + std::to_string(l.velocity / rate_hz) + ", more than its following error of " +
                std::to_string(joint.following_error),
            "allow more following error or less velocity");
  }
  require(surroundings.clearance > 0 && surroundings.clearance < 1, where,
          "the clearance is " + std::to_string(surroundings.clearance), "choose between 0 and 1 m");
}

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

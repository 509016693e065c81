#include "drivers/robot/robot.hpp"

#include <algorithm>

namespace foresight {
namespace {

using namespace std::chrono_literals;

constexpr Duration kEnableWithin = 5s;
constexpr Duration kAskAgain = 100ms;
constexpr Duration kHomeWithin = 30s;  // a joint, beside its ways
constexpr Duration kRestWithin = 3s;
constexpr Duration kStandsStill = 100ms;  // without a cycle: drives expect to hear from us within that
constexpr Duration kComesOfIt = 1s;       // what stops the robot so soon after, drives tell it only when asked again

bool is_enabled(const DriveFeedback& f) {
  return f.state == DriveState::enabled;
}
std::vector<double> velocities(const GateOptions& options) {
  std::vector<double> out;
  for (const GateJoint& joint : options.joints) out.push_back(joint.limits.velocity);
  return out;
}
bool is_faulty(const DriveFeedback& f) {
  return f.state == DriveState::fault;
}

}  // namespace

GateDoing doing_of(RobotPhase phase, GateState gate) noexcept {
  if (phase == RobotPhase::stopped) return GateDoing::stopped;
  if (phase != RobotPhase::ready) return GateDoing::away;
  switch (gate) {
    case GateState::idle: return GateDoing::idle;
    case GateState::following: return GateDoing::following;
    case GateState::stopping: return GateDoing::stopping;
    case GateState::stopped: return GateDoing::stopped;
    case GateState::homing: break;
  }
  return GateDoing::away;
}

Robot::Robot(GateOptions options, RobotShape* shape, std::vector<DriveNetwork*> networks, std::vector<Drive*> drives)
    : gate_(std::move(options), shape),
      rest_(velocities(gate_.options()), gate_.options().feedback_age_s),
      networks_(std::move(networks)),
      drives_(std::move(drives)),
      feedback_(drives_.size()) {
  publish({});
}

void Robot::submit(const MotionCommand& command) {
  const std::lock_guard lock(writers_);
  commands_.put(command);
}

void Robot::ask(RobotRequest request, std::uint64_t operator_id) noexcept {
  if (request == RobotRequest::none) return;
  if (request == RobotRequest::emergency_stop) {
    stop_asked_by_ = operator_id;
    stop_asked_ = true;
    return;
  }
  const std::lock_guard lock(writers_);
  requests_.put({request, operator_id});
}

RobotStatus Robot::status() const {
  const std::lock_guard lock(readers_);
  if (auto newer = published_.take()) last_ = *newer;
  return last_;
}

void Robot::note_standstill(RobotTime now) noexcept {
  if (last_cycle_.ns != 0 && now - last_cycle_ > kStandsStill) {
    stood_still_ = now - last_cycle_;
    went_on_ = now;
  }
  last_cycle_ = now;
}

void Robot::enter(RobotPhase phase, RobotTime now, int waiting_for) noexcept {
  if (phase == RobotPhase::ready) refused_ = "";
  if (phase != RobotPhase::stopped || now - went_on_ > kComesOfIt) stood_still_ = {};
  phase_ = phase;
  phase_since_ = now;
  waiting_for_ = waiting_for;
}

bool Robot::at_rest() const noexcept {
  return gate_.set_points_rest() && rest_.at_rest();
}

// A gripper keeps its last set-point and with it its grip, but not one that moves on its own to look for home.
void Robot::stop_all() noexcept {
  for (std::size_t i = 0; i < drives_.size(); ++i)
    if (!gate_.options().joints[i].keeps_grip || gate_.is_homing(i)) drives_[i]->request(DriveRequest::quick_stop);
}

// The gripper stays as it is here too: what it holds must not fall because the robot rests.
void Robot::disable_all() noexcept {
  for (std::size_t i = 0; i < drives_.size(); ++i)
    if (!gate_.options().joints[i].keeps_grip) drives_[i]->request(DriveRequest::disable);
}

bool Robot::all_disabled() const noexcept {
  for (std::size_t i = 0; i < drives_.size(); ++i)
    if (!gate_.options().joints[i].keeps_grip && feedback_[i].state != DriveState::disabled) return false;
  return true;
}

// The request is read before the stop: who asked for it after the stop made the stop visible, too.
void Robot::take_requests(RobotTime now) noexcept {
  const auto asked = new_requests_.take();
  if (stop_asked_.exchange(false)) {
    for (std::size_t i = 0; i < kRequestsKept && new_requests_.take(); ++i) {
    }
    last_request_ = {RobotRequest::emergency_stop, stop_asked_by_};
    refused_ = asked ? "an emergency stop came: what else was asked for is dropped" : "";
    if (phase_ == RobotPhase::enabling) stop_all();
    gate_.emergency_stop();
    if (phase_ == RobotPhase::enabling) gate_.stay_stopped(GateReason::emergency_stop);
    if (phase_ == RobotPhase::enabling) enter(RobotPhase::stopped, now);
    return;
  }
  if (!asked || ending_) return;
  last_request_ = *asked;
  refused_ = "";
  follow(asked->what, now);
}

void Robot::follow(RobotRequest request, RobotTime now) noexcept {
  const GateState gate = gate_.status().state;
  const bool free = (gate == GateState::idle || gate == GateState::stopped) && at_rest();
  switch (request) {
    case RobotRequest::none:
    case RobotRequest::emergency_stop: return;
    case RobotRequest::enable:
      if (phase_ != RobotPhase::disabled) return void(refused_ = "enable: only while disabled");
      break;
    case RobotRequest::reset:
      if (phase_ != RobotPhase::stopped) return void(refused_ = "reset: nothing is stopped");
      if (!at_rest()) return void(refused_ = "reset: wait until the robot is at rest");
      for (std::size_t i = 0; i < drives_.size(); ++i) {
        drives_[i]->request(DriveRequest::reset_fault);
        reset_asked_[i] = is_faulty(feedback_[i]);
      }
      ask_again_ = now;
      return enter(RobotPhase::enabling, now);
    case RobotRequest::set_up:
      if ((phase_ != RobotPhase::disabled && phase_ != RobotPhase::stopped) || !at_rest())
        return void(refused_ = "set up: only while disabled or stopped, and at rest");
      set_up_asked_ = true;
      return;
    case RobotRequest::disable:
      if (!free) return void(refused_ = "disable: wait until the robot is at rest");
      disable_all();
      return enter(RobotPhase::disabled, now);
    case RobotRequest::home:
      if (phase_ == RobotPhase::homing) return void(refused_ = "home: the joints are looking for it already");
      if (phase_ != RobotPhase::ready || gate != GateState::idle)
        return void(refused_ = "home: only while ready and nobody is in charge");
      if (all_homed()) return void(refused_ = "home: all joints know where they are");
      homing_ = next_to_home(0);
      homing_asked_ = false;
      return enter(RobotPhase::homing, now);
  }
  reset_asked_ = {};
  ask_again_ = now;
  enter(RobotPhase::enabling, now);
}

// Where a drive was off it may stand anywhere: set-points from before are no use. Only a gripper may have stayed on.
void Robot::forget_set_points() noexcept {
  for (std::size_t i = 0; i < drives_.size(); ++i)
    if (!gate_.options().joints[i].keeps_grip || !is_enabled(feedback_[i])) gate_.forget_set_point(i);
}

void Robot::advance_enabling(RobotTime now) noexcept {
  forget_set_points();
  const auto missing = std::find_if_not(feedback_.begin(), feedback_.end(), is_enabled);
  if (missing == feedback_.end()) {
    if (gate_.reset(feedback_, now)) return enter(RobotPhase::ready, now);
    stop_all();
    return enter(RobotPhase::stopped, now);
  }
  waiting_for_ = static_cast<int>(missing - feedback_.begin());
  // Faults are cleared first, as of a drive whose watchdog stopped it when the program ended before: whoever enables
  // has looked. Some drives need a few cycles to say that they have one. Each is asked once; what stays at fault stays
  // so.
  for (std::size_t i = 0; i < drives_.size(); ++i)
    if (is_faulty(feedback_[i]) && !std::exchange(reset_asked_[i], true))
      drives_[i]->request(DriveRequest::reset_fault);
  const bool faulty = std::any_of(feedback_.begin(), feedback_.end(), is_faulty);
  // Again and again: a drive that was not ready for the request has dropped it.
  if (!faulty && now >= ask_again_) {
    for (std::size_t i = 0; i < drives_.size(); ++i)
      if (feedback_[i].state == DriveState::disabled || feedback_[i].state == DriveState::stopping)
        drives_[i]->request(DriveRequest::enable);
    ask_again_ = now + kAskAgain;
  }
  if (now - phase_since_ < kEnableWithin) return;
  gate_.stay_stopped(GateReason::not_enabled_in_time, waiting_for_);
  stop_all();
  enter(RobotPhase::stopped, now, waiting_for_);
}

// Wherever the joint stands: to the one end, back to the other, and to the middle.
Duration Robot::home_within(std::size_t joint) const noexcept {
  const DriveConfig& d = drives_[joint]->config();
  return kHomeWithin + seconds(std::min(2.5 * (d.max_position - d.min_position) / d.homing_velocity, 3600.0));
}

std::size_t Robot::next_to_home(std::size_t from) const noexcept {
  while (from < drives_.size() && feedback_[from].homed) ++from;
  return from;
}

// After the gate has looked at all drives: if it stopped, nothing goes on here.
void Robot::advance_homing(RobotTime now) noexcept {
  waiting_for_ = static_cast<int>(homing_);
  if (!homing_asked_) {
    if (!gate_.begin_homing(homing_, now)) return;
    drives_[homing_]->request(DriveRequest::home);
    homing_asked_ = true;
    phase_since_ = now;
    return;
  }
  if (now - phase_since_ > home_within(homing_)) return gate_.emergency_stop(GateReason::homing_too_long);
  // The drive needs a few cycles to say that it has begun.
  const DriveFeedback& f = feedback_[homing_];
  if (now - phase_since_ < 200ms || !f.homed || f.state != DriveState::enabled) return;
  gate_.end_homing(f, now);
  homing_asked_ = false;
  homing_ = next_to_home(homing_ + 1);
  if (homing_ < drives_.size()) return;
  if (gate_.reset(feedback_, now)) return enter(RobotPhase::ready, now);
  gate_.emergency_stop(GateReason::homed_out_of_range);
}

/// How many of taken_ there are now.
std::size_t Robot::take_commands() noexcept {
  std::size_t count = 0;
  while (count < taken_.size()) {
    const auto command = new_commands_.take();
    if (!command) break;
    taken_[count++] = *command;
  }
  return count;
}

void Robot::let_gate_step(RobotTime now) noexcept {
  const std::size_t commands = take_commands();
  if (phase_ != RobotPhase::ready && phase_ != RobotPhase::homing && phase_ != RobotPhase::stopped) return;
  const bool may_move = phase_ == RobotPhase::ready && all_homed();
  const auto is_to_move = [](const MotionCommand& command) { return command.deadman; };
  if (phase_ == RobotPhase::ready && !may_move && std::any_of(taken_.begin(), taken_.begin() + commands, is_to_move))
    refused_ = "not all joints know where they are: home first";
  gate_.step(now, {taken_.data(), may_move ? commands : 0}, feedback_);
  if (phase_ == RobotPhase::homing && gate_.status().state != GateState::stopped) advance_homing(now);
  if (phase_ != RobotPhase::stopped && gate_.status().state == GateState::stopped)
    enter(RobotPhase::stopped, now, waiting_for_);
  // Once for all that goes wrong until the next start, and whenever it does: a drive may fail while others still brake.
  if (gate_.wants_quick_stop() && !told_to_stop_) stop_all();
  told_to_stop_ = gate_.wants_quick_stop();
  for (std::size_t i = 0; i < drives_.size(); ++i)
    if (gate_.has_set_point(i)) drives_[i]->set_point(gate_.set_point(i).position, gate_.set_point(i).velocity);
}

void Robot::cycle(RobotTime now) noexcept {
  note_standstill(now);
  for (DriveNetwork* network : networks_) network->receive(now);
  for (std::size_t i = 0; i < drives_.size(); ++i) feedback_[i] = drives_[i]->feedback();
  rest_.see(feedback_, now);
  for (DriveNetwork* network : networks_)
    if (!network->healthy() && phase_ != RobotPhase::disabled) gate_.bus_fault(network->reason());
  take_requests(now);
  if (phase_ == RobotPhase::enabling) advance_enabling(now);
  let_gate_step(now);
  for (DriveNetwork* network : networks_) network->send(now);
  publish(now);
}

bool Robot::all_homed() const noexcept {
  return std::all_of(feedback_.begin(), feedback_.end(), [](const DriveFeedback& f) { return f.homed; });
}

void Robot::publish(RobotTime now) noexcept {
  RobotStatus status;
  status.time = now;
  status.phase = phase_;
  status.gate = gate_.status();
  for (const DriveNetwork* network : networks_)
    if (!network->healthy() && status.bus_healthy) {
      status.bus_healthy = false;
      status.bus_reason = network->reason();
    }
  status.all_homed = all_homed();
  status.waiting_for = waiting_for_;
  if (phase_ == RobotPhase::stopped) status.stood_still = stood_still_;
  status.last_request = last_request_;
  status.refused = refused_;
  std::copy(feedback_.begin(), feedback_.end(), status.feedback.begin());
  for (std::size_t i = 0; i < drives_.size(); ++i) status.set_point[i] = gate_.set_point(i);
  status.loop = loop_;
  published_.put(status);
  if (now.ns != 0) hand_out(status);
}

void Robot::hand_out(const RobotStatus& status) noexcept {
  RobotCycle out;
  out.number = ++cycle_number_;
  out.time = status.time;
  out.phase = status.phase;
  out.gate = status.gate.state;
  out.reason = status.gate.reason;
  out.reason_joint = status.gate.joint;
  out.detail = status.gate.detail;
  out.hold = status.gate.hold;
  out.all_homed = status.all_homed;
  out.joints = drives_.size();
  for (std::size_t i = 0; i < drives_.size(); ++i) {
    const DriveFeedback& f = feedback_[i];
    const double asked = out.gate == GateState::following ? gate_.target(i) : std::numeric_limits<double>::quiet_NaN();
    out.joint[i] = {f.time, f.position, f.velocity, status.set_point[i], asked, f.state, f.homed};
  }
  cycles_.put(out);
}

void Robot::run(Clock& clock, std::stop_token stop, const std::function<void()>& set_up) noexcept {
  const Duration period = seconds(1 / gate_.options().rate_hz);
  RobotTime due = clock.now() + period;
  while (!stop.stop_requested()) {
    clock.sleep_until(due);
    const Duration late = clock.now() - due;
    loop_.count(late, period);
    cycle(clock.now());
    if (std::exchange(set_up_asked_, false) && set_up) {
      enter(RobotPhase::setting_up, clock.now());
      publish(clock.now());
      set_up();
      enter(RobotPhase::disabled, clock.now());
      due = clock.now();
      last_cycle_ = {};
    }
    // Skipped cycles are not made up for: set-points go on from where they are.
    due = std::max(due + period, late >= period ? clock.now() : due);
  }
  shut_down(clock, due);
}

void Robot::shut_down(Clock& clock, RobotTime due) noexcept {
  const Duration period = seconds(1 / gate_.options().rate_hz);
  const auto cycle_once = [&] {
    clock.sleep_until(due);
    cycle(clock.now());
    due = clock.now() + period;
  };
  ending_ = true;
  if (phase_ == RobotPhase::enabling) stop_all();
  gate_.emergency_stop(GateReason::program_ends);
  if (phase_ != RobotPhase::disabled) enter(RobotPhase::stopped, clock.now());
  const RobotTime until = clock.now() + kRestWithin;
  do cycle_once();
  while (!at_rest() && clock.now() < until);
  disable_all();
  enter(RobotPhase::disabled, clock.now());
  const RobotTime disabled_until = clock.now() + 1s;
  do cycle_once();
  while (!all_disabled() && clock.now() < disabled_until);
  ending_ = false;
}

}  // namespace foresight

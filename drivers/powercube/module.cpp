#include "drivers/powercube/module.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace foresight::powercube {
namespace {

using namespace std::chrono_literals;

constexpr std::uint32_t kRepeatCycles = 5;  // a lost Halt is sent again after so many
constexpr std::uint32_t kAskWhileStepping = 5;
constexpr Duration kEnableTime = 1s;          // from the request until the module has left its halt
constexpr Duration kResetRepeatTime = 100ms;  // a lost Reset is sent again
constexpr Duration kHomeBeginTime = 1s;       // until homing shows in the state word
constexpr double kReachedTolerance = 1e-3;    // rad or m
constexpr std::uint32_t kBusy = kMotion | kInProgress;

double milliseconds(Duration d) {
  return std::max(1.0, std::round(to_seconds(d) * 1e3));
}

}  // namespace

// --- what the module says -------------------------------------------------------------------------------------------

void Module::take(const Message& m, RobotTime time) noexcept {
  silent_ = 0;
  if (state_ == DriveState::offline) {
    enter(DriveState::stopping);  // whatever it did meanwhile, it begins anew from a halt
    want_halt_ = true;
  }
  using Kind = Message::Kind;
  if (m.is(Kind::value, Param::cube_state)) {
    take_state(static_cast<std::uint32_t>(m.value));
  } else if (m.is(Kind::value, Param::act_pos)) {
    take_position(m.value, time);
  } else if (m.is(Kind::value, Param::act_vel)) {
    if (std::isfinite(m.value)) velocity_ = m.value;
  } else if (m.kind == Kind::value) {
    take_proof(m);
  } else if (m.kind == Kind::position) {
    take_position(m.value, time);
    ramp_answered_ = true;
    if (state_ == DriveState::enabled && (m.short_state & kShortNotOk) != 0) fail("reports that it is not ok");
  } else if (m.kind == Kind::motion_answer && !m.accepted && state_ == DriveState::enabled) {
    fail("refused a set-point");
  } else if (m.kind == Kind::order_answer && m.accepted && Command{m.code} == Command::home) {
    // One that stands at home already is done before its state word is asked for again.
    if (state_ == DriveState::homing) homing_seen_ = true;
  }
}

void Module::take_state(std::uint32_t word) noexcept {
  const std::uint32_t before = std::exchange(word_, word);
  word_fresh_ = true;
  if (*fault_of(word & ~std::uint32_t{kBeyondSoft}) != '\0') {  // that bit alone is a limit, see feedback()
    if (state_ != DriveState::fault) {
      own_fault_ = "";
      enter(DriveState::fault);
      want_halt_ = true;
    }
    return;
  }
  const bool halted = word_is(kHalted);
  switch (state_) {
    case DriveState::fault:
      if (*own_fault_ == '\0') enter(DriveState::stopping);
      break;
    case DriveState::stopping:
      if (halted && !word_is(kMotion)) enter(DriveState::disabled);
      break;
    case DriveState::disabled:
      if (!halted) enter(DriveState::stopping);
      break;
    case DriveState::enabling:
      // The brake opened: where it stood before is not where it stands now.
      if (!halted && (before & kHalted) != 0) position_fresh_ = false;
      break;
    case DriveState::homing:
      if (word_is(kBusy) || !word_is(kHomeOk)) homing_seen_ = true;
      if (homing_seen_ && !word_is(kBusy) && word_is(kHomeOk) && !homing_done_) {
        homing_done_ = true;
        position_fresh_ = false;  // homing moves the zero
      }
      [[fallthrough]];
    case DriveState::enabled:
      if (halted) fail("halted without our asking: its watchdog, or another master");
      break;
    case DriveState::offline: break;
  }
}

void Module::take_proof(const Message& m) noexcept {
  if (state_ != DriveState::enabling) return;
  for (std::size_t i = 0; i < kProven; ++i) {
    if (!m.is(Message::Kind::value, proven_[i].param)) continue;
    if (!equal(proven_[i].param, m.value, proven_[i].value))
      return fail("lost its limits or watchdog: configure it again");
    proofs_ |= 1u << i;
  }
}

void Module::take_position(double wire, RobotTime time) noexcept {
  if (!std::isfinite(wire)) return;
  position_ = wire;
  position_time_ = time;
  position_fresh_ = true;
  without_position_ = 0;
}

void Module::check(RobotTime now) noexcept {
  now_ = now;
  // By cycles, not by the clock: a loop that was late has asked nothing meanwhile.
  if (state_ == DriveState::offline || silent_ <= options_.missing_cycles) return;
  own_fault_ = "";
  velocity_.reset();
  enter(DriveState::offline);
}

void Module::enter(DriveState state) noexcept {
  state_ = state;
  entered_ = action_time_ = now_;
  proofs_ = 0;
  reset_sent_ = word_fresh_ = position_fresh_ = homing_seen_ = homing_done_ = false;
  ramp_answered_ = true;
  target_.reset();
  last_sent_ = position_;
}

void Module::fail(const char* why) noexcept {
  own_fault_ = why;
  enter(DriveState::fault);
  want_halt_ = true;
}

// --- what is asked of it --------------------------------------------------------------------------------------------

void Module::request(DriveRequest what) noexcept {
  if (request_ != DriveRequest::quick_stop && what != DriveRequest::none) request_ = what;
}

void Module::set_point(double position, double /*velocity*/) noexcept {
  if (state_ != DriveState::enabled || !word_is(kHomeOk) || !std::isfinite(position)) return;
  target_ = std::clamp(position, config_.min_position, config_.max_position);
}

DriveFeedback Module::feedback() const noexcept {
  DriveFeedback out;
  out.time = position_time_;
  if (position_time_.ns != 0) out.position = to_joint(position_);
  if (velocity_) out.velocity = config_.direction * *velocity_;
  out.state = state_;
  out.homed = word_is(kHomeOk);
  const double goal = target_ ? to_wire(*target_) : last_sent_;
  out.target_reached = state_ == DriveState::enabled && std::abs(position_ - goal) < kReachedTolerance;
  out.limit = word_is(kSwitch1 | kSwitch2 | kCurrentLimit | kBeyondSoft | kBeyondHard);
  out.fault_code = word_;
  if (state_ == DriveState::offline) out.fault = "does not answer";
  if (state_ == DriveState::fault) out.fault = *fault_of(word_) != '\0' ? fault_of(word_) : own_fault_;
  return out;
}

void Module::obey() noexcept {
  const bool live = state_ == DriveState::enabling || state_ == DriveState::enabled || state_ == DriveState::homing;
  switch (std::exchange(request_, DriveRequest::none)) {
    case DriveRequest::none: break;
    case DriveRequest::enable:
      if (state_ == DriveState::disabled && configured_) enter(DriveState::enabling);
      break;
    case DriveRequest::disable:
    case DriveRequest::quick_stop:
      if (live) enter(DriveState::stopping);
      want_halt_ = true;
      break;
    case DriveRequest::home:
      if (state_ != DriveState::enabled) break;
      enter(DriveState::homing);
      want_home_ = true;
      break;
    case DriveRequest::reset_fault:
      if (state_ != DriveState::fault) break;
      own_fault_ = "";
      want_reset_ = want_halt_ = true;
      break;
  }
}

// --- what we send ---------------------------------------------------------------------------------------------------

void Module::send(RobotTime now, CanBus& bus) noexcept {
  now_ = now;
  ++cycles_;
  silent_ = std::min(silent_ + 1, options_.missing_cycles + 1);
  without_position_ = std::min(without_position_ + 1, options_.missing_cycles + 1);
  obey();
  if (state_ == DriveState::homing) watch_homing();
  if (state_ == DriveState::enabling) send_enabling(bus);
  if (state_ == DriveState::enabled) send_enabled(bus);
  send_orders(bus);
}

void Module::send_orders(CanBus& bus) noexcept {
  // Reset opens the halt, so a Halt that belongs to it follows at once.
  if (std::exchange(want_reset_, false)) bus.send(command(config_.node, Command::reset));
  const bool should_stand = state_ == DriveState::offline || state_ == DriveState::stopping ||
                            (state_ == DriveState::fault && !word_is(kHalted));
  if (std::exchange(want_halt_, false) || (should_stand && cycles_ % kRepeatCycles == 0)) {
    bus.send(command(config_.node, Command::halt));
  }
  if (std::exchange(want_home_, false) && state_ == DriveState::homing) {
    bus.send(command(config_.node, Command::home));
  }
}

void Module::send_enabling(CanBus& bus) noexcept {
  if (now_ - entered_ > kEnableTime) {
    return fail(reset_sent_ ? "does not leave its halt" : "does not tell its limits and watchdog");
  }
  if (proofs_ != (1u << kProven) - 1) {
    for (std::size_t i = 0; i < kProven; ++i)
      if ((proofs_ >> i & 1u) == 0) bus.send(get_param(config_.node, proven_[i].param));
    return;
  }
  if (!reset_sent_ || (word_is(kHalted) && now_ - action_time_ > kResetRepeatTime)) {
    bus.send(command(config_.node, Command::reset));
    reset_sent_ = true;
    word_fresh_ = position_fresh_ = false;
    action_time_ = now_;
    return;
  }
  if (word_fresh_ && !word_is(kHalted) && position_fresh_) enter(DriveState::enabled);
}

void Module::send_enabled(CanBus& bus) noexcept {
  if (!word_is(kHomeOk)) return;
  if (without_position_ > options_.missing_cycles) return fail("does not answer set-points");
  double wire = target_ ? to_wire(*target_) : last_sent_;
  if (options_.set_points == SetPoints::ramp) {
    if (target_ && send_ramp(wire, bus)) last_sent_ = wire;
    return;
  }
  const double most = config_.max_velocity * to_seconds(options_.cycle);
  wire = std::clamp(wire, last_sent_ - most, last_sent_ + most);
  bus.send(motion(config_.node, Motion::fstep_ack, wire, milliseconds(options_.cycle)));
  last_sent_ = wire;
}

bool Module::send_ramp(double wire, CanBus& bus) noexcept {
  const bool lost = !ramp_answered_ && now_ - action_time_ > 3 * options_.cycle;
  if (wire == last_sent_ && !lost) return false;
  ramp_answered_ = false;
  action_time_ = now_;
  return bus.send(motion(config_.node, Motion::framp_ack, wire)) == CanSend::sent;
}

void Module::watch_homing() noexcept {
  const double travel = config_.max_position - config_.min_position;
  const Duration longest = seconds(std::min(1e6, 2 * travel / config_.homing_velocity + 10));
  if (homing_done_ && position_fresh_) return enter(DriveState::enabled);
  if (!homing_seen_ && now_ - entered_ > kHomeBeginTime) return fail("did not begin to home");
  if (now_ - entered_ > longest) fail("homing takes too long");
}

// One question a cycle: eight modules at 250 Hz would fill the bus with more. Behind set-points, whose answers hold
// position and the most important bits, only now and then.
void Module::ask(CanBus& bus) noexcept {
  const bool stepping = state_ == DriveState::enabled && word_is(kHomeOk) && options_.set_points == SetPoints::step;
  const std::uint32_t turn_of_all = cycles_ + static_cast<std::uint32_t>(config_.node);  // not all in one cycle
  if (stepping && turn_of_all % kAskWhileStepping != 0) return;
  const std::uint32_t turn = stepping ? turn_of_all / kAskWhileStepping : cycles_;
  // The state before the position: a position that follows "homed" is one after homing.
  if (turn % 2 == 0 || state_ == DriveState::offline)
    bus.send(get_param(config_.node, Param::cube_state));
  else if (stepping || turn % 8 == 7)
    bus.send(get_param(config_.node, Param::act_vel));
  else
    bus.send(get_param(config_.node, Param::act_pos));
}

}  // namespace foresight::powercube

#include "tests/control/session_world.hpp"

#include <algorithm>
#include <cmath>
#include <random>
#include <unordered_map>
#include <utility>

#include "drivers/robot/robot.hpp"
#include "link/control/control_seat.hpp"
#include "link/line/delay_line.hpp"
#include "operators/line_operator.hpp"
#include "tests/robot/prompt_drive.hpp"
#include "tests/support/random_line.hpp"

namespace foresight {
namespace {

using namespace std::chrono_literals;

constexpr std::int64_t kMs = 1'000'000;
constexpr std::int64_t kStep = 2 * kMs, kCycle = 4 * kMs, kTick = 10 * kMs;
constexpr std::int64_t kWatchdog = 60 * kMs;  // of the drives
constexpr double kDt = 0.004;

class Dice {
 public:
  explicit Dice(std::uint64_t seed) : random_(seed) {}
  double uniform(double a, double b) { return std::uniform_real_distribution(a, b)(random_); }
  bool chance(double share) { return uniform(0, 1) < share; }
  std::size_t below(std::size_t n) { return std::uniform_int_distribution<std::size_t>(0, n - 1)(random_); }
  std::uint64_t number() { return random_(); }

 private:
  std::mt19937_64 random_;
};

/// A host's clock, and whether its programs run. Instants in true ns.
struct Host {
  std::int64_t offset = 0;
  double drift = 0;
  std::int64_t dead_until = 0, paused_until = 0, suspended_until = 0;
  std::int64_t clock(std::int64_t now) const { return offset + now + std::llround(drift * static_cast<double>(now)); }
  bool runs(std::int64_t now) const { return now >= std::max({dead_until, paused_until, suspended_until}); }
};

/// Keeps the drives' feedback fresh; they stop when nobody speaks to them.
class WatchedNetwork final : public DriveNetwork {
 public:
  explicit WatchedNetwork(std::vector<PromptDrive>& drives) : drives_(drives) {}
  std::span<Drive* const> drives() const noexcept override { return {}; }
  void receive(RobotTime now) noexcept override {
    for (PromptDrive& drive : drives_) drive.state.time = now;
  }
  void send(RobotTime) noexcept override { spoken_ = true; }
  bool healthy() const noexcept override { return true; }
  const char* reason() const noexcept override { return ""; }
  void pass(std::int64_t now) {
    if (std::exchange(spoken_, false)) spoken_at_ = now;
    if (now - spoken_at_ <= kWatchdog) return;
    for (PromptDrive& drive : drives_)
      if (drive.state.state == DriveState::enabled) drive.state.state = DriveState::disabled;
  }

 private:
  std::vector<PromptDrive>& drives_;
  bool spoken_ = false;
  std::int64_t spoken_at_ = 0;
};

GateOptions gate_options() {
  GateOptions out;
  out.joints = {{"arm", {-2, 2, 1, 4, 60}, 0.2}, {"wrist", {-1, 1, 2, 8, 120}, 0.2}};
  out.ramp_s = 0.2;
  return out;
}

Identity identity(const std::string& name) {
  return {kLineProtocol, "1.0", name, 11, 22, 33, {"arm", "wrist"}};
}

RandomLineOptions any_line(Dice& dice) {
  RandomLineOptions out;
  out.base_s = 2e-4 * std::pow(10, dice.uniform(0, 2.7));  // 0.2 to 100 ms
  out.jitter_s = out.base_s * dice.uniform(0, 0.5);
  out.congested_share = dice.uniform(0, 0.2);
  out.congestion_s = dice.uniform(0, 0.5);
  out.loss = dice.chance(0.5) ? dice.uniform(0, 0.1) : 0;
  out.burst_share = dice.uniform(0, 0.05);
  out.outage_share = dice.chance(0.5) ? dice.uniform(0, 0.2) : 0;
  out.outage_keeps = dice.chance(0.5);
  out.duplicated = dice.uniform(0, 0.2);
  out.late = dice.uniform(0, 0.1);
  out.late_s = dice.uniform(0, 3);
  out.in_order = dice.chance(0.3);
  return out;
}

/// Behind 20 ms, as of the way to where it was recorded.
template <typename T>
void follow_trace(RandomLine<T>& line, const std::shared_ptr<const Trace>& trace, Dice& dice) {
  if (trace == nullptr) return;
  DirectionSpec spec;
  spec.delay = 20ms;
  spec.trace = trace;
  const std::int64_t later = std::llround(dice.uniform(0, 1) * static_cast<double>(period_of(*trace).count()));
  const auto carrier = std::make_shared<DelayLine>(spec, RobotTime{0}, dice.number());
  line.carry_by([carrier, later](std::int64_t now) -> std::optional<std::int64_t> {
    constexpr std::size_t kBytes = 300;
    const auto at = carrier->send({now + later}, kBytes);
    if (!at) return std::nullopt;
    return at->ns - later;
  });
}

struct Press {
  std::size_t who = 0;
  int instance = 0;       // of the operator's program
  std::int64_t saw = -1;  // when the newest state that its operator had then was made
  bool over = false;      // the robot has stopped since it began to follow it
};
struct Given {
  std::size_t press = 0;
  std::uint64_t number = 0;
  std::int64_t expires = 0;
};
struct ToRobot {
  FromOperator message;
  std::int64_t sent = 0;
};
struct ToOperator {
  FromRobot message;
  std::int64_t made = 0;
};

class World {
 public:
  World(std::uint64_t seed, const SessionLine& line) : dice_(seed) {
    for (PromptDrive& drive : drives_) drive.state.homed = true;
    robot_host_ = any_host();
    const std::size_t people = dice_.chance(0.6) ? 2 : 1;
    for (std::size_t i = 0; i < people; ++i) people_.emplace_back(any_line(dice_), any_line(dice_), dice_.number());
    for (Person& person : people_) {
      person.host = any_host();
      follow_trace(person.down, line.up, dice_);
      follow_trace(person.up, line.down, dice_);
    }
    replays_ = dice_.chance(0.4);
    next_fault_ = std::llround(dice_.uniform(2, 6) * 1e9);
    start_robot();
  }
  SessionCounts run(double seconds) {
    for (const std::int64_t end = std::llround(seconds * 1e9); now_ < end; now_ += kStep) {
      maybe_fault();
      for (std::size_t i = 0; i < people_.size(); ++i) step_person(i);
      replay();
      step_robot();
      network_.pass(now_);
      check_drives();
    }
    end_program();
    return counts_;
  }

 private:
  struct Person {
    Person(RandomLineOptions there, RandomLineOptions back, std::uint64_t seed)
        : up(there, seed), down(back, seed + 1) {}
    Host host;
    RandomLine<ToRobot> up;
    RandomLine<ToOperator> down;
    std::vector<ToOperator> buffer;  // of a program that is paused
    std::unique_ptr<ControlSeat> seat;
    int instance = 0;
    std::int64_t saw = -1;
    // What the person does.
    bool wants = false, pressed = false;
    std::int64_t until = 0, pressed_at = 0, next_request = 0, next_want = 0;
    std::size_t press = 0;
    bool stubborn = false;
    LinePositions from{};
    double pace = 1, width = 0.5;
  };

  Host any_host() { return {std::llround(dice_.uniform(1, 1e6) * 1e9), dice_.uniform(-50e-6, 50e-6)}; }
  DrawNonce draw() {
    return [this] { return dice_.number() | 1; };
  }

  void start_robot() {
    robot_ = std::make_unique<Robot>(gate_options(), nullptr, std::vector<DriveNetwork*>{&network_},
                                     std::vector<Drive*>{&drives_[0], &drives_[1]});
    cycles_ = robot_->cycles();
    ControlDeskOptions desk;
    desk.identity = identity("the robot");
    desk.draw = draw();
    line_ = std::make_unique<LineOperator>(gate_options(), desk);
    following_.reset();
  }
  void end_program() {
    if (line_ == nullptr) return;
    const auto& faults = line_->desk().counts().faults;
    for (std::size_t i = 0; i < faults.size(); ++i) counts_.dropped[i] += faults[i];
    line_.reset();
    robot_.reset();
    cycles_.reset();
    buffer_.clear();
    note_stop(false);
  }
  void start_seat(Person& person) {
    ++person.instance;
    person.seat = std::make_unique<ControlSeat>(ControlSeatOptions{identity("somebody"), draw()});
    person.wants = person.pressed = false;
    person.saw = -1;
  }

  void maybe_fault() {
    if (now_ < next_fault_) return;
    next_fault_ = now_ + std::llround(dice_.uniform(1, 10) * 1e9);
    ++counts_.faults;
    const bool robots = dice_.chance(0.4);
    Person& person = people_[dice_.below(people_.size())];
    Host& host = robots ? robot_host_ : person.host;
    const std::int64_t length = std::llround(1e9 * 0.02 * std::pow(10, dice_.uniform(0, 2.2)));  // 20 ms to 3 s
    switch (dice_.below(6)) {
      case 0:
        host.dead_until = now_ + length;
        if (robots) end_program();
        if (!robots) person.seat.reset(), person.buffer.clear();
        break;
      case 1: host.paused_until = now_ + length; break;
      case 2:
        // Its clock stands still meanwhile, and nothing is received.
        host.suspended_until = now_ + 300 * kMs + length;
        host.offset -= 300 * kMs + length;
        break;
      case 3: host.offset += std::llround(dice_.uniform(1, 3) * 1e9); break;
      case 4:
        if (!robots) host.offset -= 1'000'000'000;
        break;
      case 5:
        if (robots && robot_ != nullptr) robot_->ask(RobotRequest::emergency_stop);
        if (!robots && line_ != nullptr && line_->desk().consent_to_asking(robot_now())) ++counts_.handed_over;
        break;
      default: break;
    }
  }

  RobotTime robot_now() const { return {robot_host_.clock(now_)}; }

  // The robot's side.

  void step_robot() {
    std::vector<FromOperator> arrived = std::exchange(injected_, {});
    for (Person& person : people_)
      for (ToRobot& packet : person.up.take(now_)) arrived.push_back(std::move(packet.message));
    if (now_ < std::max(robot_host_.dead_until, robot_host_.suspended_until)) return;
    buffer_.insert(buffer_.end(), arrived.begin(), arrived.end());
    if (now_ < robot_host_.paused_until) return;
    if (robot_ == nullptr) start_robot();
    const RobotTime now = robot_now();
    for (const FromOperator& message : std::exchange(buffer_, {})) line_->desk().receive(message, now);
    if (now_ % kTick == 0) tick_robot(now);
    if (now_ % kCycle == 0) {
      robot_->cycle(now);
      while (const auto cycle = cycles_->take()) judge(*cycle);
    }
  }
  void tick_robot(RobotTime now) {
    const OperatorWish wish = line_->tick(now, robot_->status());
    robot_->ask(wish.request, LineOperator::kId);
    if (wish.command) robot_->submit(*wish.command);
    for (const FromRobot& message : line_->desk().take_outgoing()) {
      if (replays_ && now_ < kRecorded) recorded_down_.push_back({now_, message});
      for (Person& person : people_) person.down.send(now_, {message, now_});
    }
  }

  // What the robot does, against what people did.

  void judge(const RobotCycle& cycle) {
    bool moving = false;
    for (std::size_t i = 0; i < cycle.joints; ++i) {
      const JointMotion &m = cycle.joint[i].set_point, &before = before_[i];
      const JointLimits l = gate_options_.joints[i].limits;
      // What a drive without torque is told is no motion.
      moving = moving || ((m.velocity != 0 || m.acceleration != 0) && drives_[i].state.state == DriveState::enabled);
      const bool within = m.position >= l.min_position - 1e-9 && m.position <= l.max_position + 1e-9 &&
                          std::abs(m.velocity) <= l.velocity * (1 + 1e-9) &&
                          std::abs(m.acceleration) <= l.acceleration * (1 + 1e-9) &&
                          std::abs(m.acceleration - before.acceleration) <= l.jerk * kDt * (1 + 1e-6);
      if (!within && cycle.number > 1) ++counts_.limits_exceeded;
      before_[i] = m;
    }
    if (cycle.gate == GateState::following) {
      judge_following(cycle.joint[0].asked);
    } else if (following_) {
      note_stop(cycle.reason == GateReason::deadman_released);
    }
    if (!moving) return;
    ++counts_.cycles_moving;
    counts_.longest_to_rest_s = std::max(counts_.longest_to_rest_s, 1e-9 * static_cast<double>(now_ - last_expiry_));
    if (now_ > last_expiry_ + 150 * kMs + stop_ns_) ++counts_.rest_late;
  }
  void judge_following(double asked) {
    const auto found = given_.find(asked);
    if (found == given_.end()) {
      ++counts_.without_consent;
      return;
    }
    const Given& given = found->second;
    if (now_ > given.expires + kMs / 10) ++counts_.executed_late;
    if (given.number < followed_number_) ++counts_.went_back;
    followed_number_ = given.number;
    last_expiry_ = std::max(last_expiry_, given.expires);
    if (following_ == given.press) return;
    Press& press = presses_[given.press];
    const bool fresh = !press.over && press.instance == people_[press.who].instance &&
                       (stop_was_own_ || press.saw >= stopped_at_ - 20 * kMs);
    if (!fresh) ++counts_.without_consent;
    if (following_) presses_[*following_].over = true;
    following_ = given.press;
    ++counts_.motions;
  }
  /// `own`: by the open switch of the one who drove.
  void note_stop(bool own) {
    if (following_) presses_[*following_].over = true;
    following_.reset();
    stop_was_own_ = own;
    stopped_at_ = now_;
  }
  /// A drive that moves does so in a motion that was judged.
  void check_drives() {
    for (std::size_t i = 0; i < drives_.size(); ++i) {
      if (drives_[i].state.position != stood_[i] && now_ > last_expiry_ + 150 * kMs + stop_ns_) ++counts_.rest_late;
      stood_[i] = drives_[i].state.position;
    }
  }

  // The operators.

  void step_person(std::size_t who) {
    Person& person = people_[who];
    auto arrived = person.down.take(now_);
    if (now_ < std::max(person.host.dead_until, person.host.suspended_until)) return;
    std::move(arrived.begin(), arrived.end(), std::back_inserter(person.buffer));
    if (now_ < person.host.paused_until) return;
    if (person.seat == nullptr) start_seat(person);
    const OperatorTime now{person.host.clock(now_)};
    for (const ToOperator& packet : std::exchange(person.buffer, {})) {
      const std::uint64_t before = person.seat->state().sequence;
      person.seat->receive(packet.message, now);
      if (person.seat->state().sequence != before) person.saw = std::max(person.saw, packet.made);
    }
    if (now_ % kTick == static_cast<std::int64_t>(2 + 2 * who) * kMs) tick_person(who, now);
  }
  void tick_person(std::size_t who, OperatorTime now) {
    Person& person = people_[who];
    person.seat->advance(now);
    act(who, now);
    for (FromOperator& message : person.seat->take_outgoing()) {
      if (const auto* point = std::get_if<SetPoint>(&message.body); point != nullptr && point->deadman) {
        ++counts_.set_points;
        given_[point->position[0]] = {person.press, ++numbers_, now_ + point->lasts.count()};
      }
      if (replays_ && now_ < kRecorded) recorded_up_.push_back({now_, message});
      person.up.send(now_, {std::move(message), now_});
    }
  }
  void act(std::size_t who, OperatorTime now) {
    Person& person = people_[who];
    const ControlSeatStatus status = person.seat->status(now);
    if (now_ >= person.next_want) {
      // Wants control most of the time, and hands it over or gives it back now and then.
      const bool wants = dice_.chance(0.8);
      if (person.wants && dice_.chance(0.5) && person.seat->hand_over()) ++counts_.handed_over;
      if (wants != person.wants) person.seat->want_control(wants);
      person.wants = wants;
      person.next_want = now_ + std::llround(dice_.uniform(2, 15) * 1e9);
    }
    if (status.phase != ControlSeatStatus::Phase::holding) return;
    if (!person.seat->state().ready && now_ >= person.next_request) {
      person.seat->request(dice_.chance(0.5) ? LineRequest::enable : LineRequest::reset, now);
      person.next_request = now_ + std::llround(dice_.uniform(0.3, 1.5) * 1e9);
    }
    hold_switch(who, status);
    person.seat->command(now, position(person), person.pressed);
  }
  void hold_switch(std::size_t who, const ControlSeatStatus& status) {
    Person& person = people_[who];
    // Most let go when they are told to.
    if (person.pressed && !person.stubborn && status.must_let_go && now_ > person.pressed_at + 500 * kMs)
      person.until = std::min(person.until, now_ + 200 * kMs);
    if (now_ < person.until) return;
    person.pressed = !person.pressed;
    if (!person.pressed) {
      person.until = now_ + std::llround(dice_.uniform(0.02, 0.8) * 1e9);
      return;
    }
    person.stubborn = dice_.chance(0.3);
    person.until = now_ + std::llround((person.stubborn ? dice_.uniform(1, 6) : dice_.uniform(0.02, 4)) * 1e9);
    person.pressed_at = now_;
    person.from = person.seat->begin();
    person.pace = dice_.uniform(0.3, 3);
    person.width = dice_.uniform(-1, 1);
    person.press = presses_.size();
    presses_.push_back({who, person.instance, person.saw});
    ++counts_.presses;
  }
  LinePositions position(const Person& person) {
    LinePositions out = person.pressed ? person.from : person.seat->begin();
    const double t = 1e-9 * static_cast<double>(now_ - person.pressed_at);
    if (person.pressed) out[0] += person.width * std::sin(person.pace * t);
    if (person.pressed) out[1] += 0.5 * person.width * std::sin(2 * person.pace * t);
    out[1] = std::clamp(out[1], -0.999, 0.999);
    // Every set-point can be told from all others.
    out[0] = std::round(1e3 * std::clamp(out[0], -1.99, 1.99)) * 1e-3 + 1e-9 * static_cast<double>(++unique_);
    return out;
  }

  /// What was recorded in the first seconds is played again on the same domain.
  void replay() {
    if (!replays_ || now_ < kReplayed) return;
    const std::int64_t then = now_ - kReplayed + kStep;
    for (; up_at_ < recorded_up_.size() && recorded_up_[up_at_].first < then; ++up_at_, ++counts_.replayed)
      injected_.push_back(recorded_up_[up_at_].second);
    for (; down_at_ < recorded_down_.size() && recorded_down_[down_at_].first < then; ++down_at_, ++counts_.replayed)
      for (Person& person : people_) person.buffer.push_back({recorded_down_[down_at_].second, 0});
  }

  static constexpr std::int64_t kRecorded = 8'000'000'000, kReplayed = 12'000'000'000;
  Dice dice_;
  std::int64_t now_ = 0, next_fault_ = 0;
  Host robot_host_;
  std::vector<PromptDrive> drives_{std::vector<PromptDrive>(2)};
  WatchedNetwork network_{drives_};
  GateOptions gate_options_ = gate_options();
  std::unique_ptr<Robot> robot_;
  std::optional<BroadcastRing<RobotCycle>::Reader> cycles_;
  std::unique_ptr<LineOperator> line_;
  std::vector<FromOperator> buffer_, injected_;
  std::vector<Person> people_;
  bool replays_ = false;
  std::vector<std::pair<std::int64_t, FromOperator>> recorded_up_;
  std::vector<std::pair<std::int64_t, FromRobot>> recorded_down_;
  std::size_t up_at_ = 0, down_at_ = 0;

  std::array<JointMotion, 2> before_{};
  std::array<double, 2> stood_{};
  std::vector<Press> presses_;
  std::unordered_map<double, Given> given_;
  std::uint64_t unique_ = 0, numbers_ = 0, followed_number_ = 0;
  std::optional<std::size_t> following_;  // which press
  bool stop_was_own_ = true;
  std::int64_t stopped_at_ = 0, last_expiry_ = 0;
  std::int64_t stop_ns_ = std::llround(session_stop_s() * 1e9);
  SessionCounts counts_;
};

}  // namespace

SessionCounts& SessionCounts::operator+=(const SessionCounts& o) {
  executed_late += o.executed_late;
  without_consent += o.without_consent;
  went_back += o.went_back;
  limits_exceeded += o.limits_exceeded;
  rest_late += o.rest_late;
  motions += o.motions;
  cycles_moving += o.cycles_moving;
  set_points += o.set_points;
  presses += o.presses;
  handed_over += o.handed_over;
  faults += o.faults;
  replayed += o.replayed;
  for (std::size_t i = 0; i < dropped.size(); ++i) dropped[i] += o.dropped[i];
  longest_to_rest_s = std::max(longest_to_rest_s, o.longest_to_rest_s);
  return *this;
}

double session_stop_s() {
  double out = 0;
  for (const GateJoint& joint : gate_options().joints) {
    // At full speed, and still about to speed up: the worst that the limits allow.
    JointMotion m{0, joint.limits.velocity, joint.limits.acceleration};
    int cycles = 0;
    while (m.velocity != 0 || m.acceleration != 0) {
      m = brake(m, joint.limits, kDt);
      ++cycles;
    }
    out = std::max(out, cycles * kDt);
  }
  return out;
}

SessionCounts run_session(std::uint64_t seed, const SessionLine& line) {
  return World(seed, line).run(30);
}

}  // namespace foresight

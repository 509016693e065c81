#include "operators/station_operator.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace foresight {
namespace {

using namespace std::chrono_literals;

constexpr Duration kOpenFor = 50ms;    // before engaging
constexpr Duration kHeldBack = 2s;     // without a step nearer
constexpr Duration kStillFor = 300ms;  // measured positions, before anybody looks
constexpr double kArrived = 1e-3;      // rad or m, of set-points
constexpr double kStill = 5e-4;        // rad or m: more than encoders' noise, less than a camera sees

}  // namespace

StationOperator::StationOperator(std::vector<JointWords> joints, bool may_home)
    : joints_(std::move(joints)), start_(may_home) {}

OperatorWish StationOperator::fail(std::string why) {
  failure_ = std::move(why);
  return {.quit = true};
}

void StationOperator::enter(Step step, RobotTime now) {
  step_ = step;
  since_ = moved_ = now;
  engaged_ = still_ = false;
}

OperatorWish StationOperator::command(RobotTime now, bool deadman) {
  return {.command = counter_.command(now, deadman, joints_.size(), target_)};
}

std::string StationOperator::reason(const RobotStatus& status) const {
  const RobotWords words = describe(status, joints_);
  return words.cure.empty() ? words.name : words.name + "; " + words.cure;
}

std::string StationOperator::kept_from(const RobotStatus& status, RobotTime now) const {
  if (const std::string held = hold_text(status.gate.hold, joints_, now); !held.empty()) return held;
  if (status.gate.last_dropped != GateReason::none) return words_for(status.gate.last_dropped).name;
  return "the robot did not come there";
}

void StationOperator::watch_rest(RobotTime now, const RobotStatus& status) {
  bool moved = status.gate.state != GateState::idle;
  for (std::size_t i = 0; i < joints_.size(); ++i)
    moved = moved || !(std::abs(status.feedback[i].position - held_[i]) < kStill);
  if (moved) {
    for (std::size_t i = 0; i < joints_.size(); ++i) held_[i] = status.feedback[i].position;
    moved_ = now;
  }
  still_ = now - moved_ >= kStillFor;
  if (still_) still_since_ = moved_;
}

void StationOperator::go_to(const JointValues& positions) {
  target_ = positions;
  missed_.clear();
  step_ = Step::engage;
  since_ = {};
}

OperatorWish StationOperator::tick(RobotTime now, const RobotStatus& status) {
  if (step_ == Step::done) {
    if (status.gate.state == GateState::idle || status.phase == RobotPhase::stopped) return {.quit = true};
    return command(now, false);
  }
  if (!failure_.empty()) return {.quit = true};
  if (since_.ns == 0) enter(step_, now);
  if (status.phase == RobotPhase::stopped) return fail("the robot stopped: " + reason(status));
  switch (step_) {
    case Step::start: {
      const RobotStart::Progress start = start_.tick(now, status);
      if (!start.failure.empty()) return fail(start.failure);
      if (start.ready) enter(Step::wait, now);
      return {.request = start.request};
    }
    case Step::wait: watch_rest(now, status); return {};
    case Step::engage:
      if (now - since_ > kOpenFor) enter(Step::move, now);
      return command(now, false);
    case Step::move: {
      const bool in_charge = status.gate.state == GateState::following && status.gate.operator_id == kId;
      if (engaged_ && !in_charge) return fail("the robot was taken away: " + reason(status));
      engaged_ = engaged_ || in_charge;
      double farthest = 0, fastest = 0;
      for (std::size_t i = 0; i < joints_.size(); ++i) {
        farthest = std::max(farthest, std::abs(status.set_point[i].position - target_[i]));
        fastest = std::max(fastest, std::abs(status.set_point[i].velocity));
      }
      if (fastest > 0) moved_ = now;
      if (now - moved_ > kHeldBack) {
        missed_ = kept_from(status, now);
        enter(Step::release, now);
      } else if (farthest < kArrived) {
        enter(Step::release, now);
      }
      return command(now, step_ == Step::move);
    }
    case Step::release:
      if (status.gate.state == GateState::idle) enter(Step::wait, now);
      return command(now, false);
    case Step::done: break;
  }
  return {};
}

}  // namespace foresight

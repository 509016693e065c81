#include "apps/robot/operators.hpp"

#include <algorithm>
#include <cmath>

namespace foresight {
namespace {

using namespace std::chrono_literals;

constexpr std::uint64_t kFileOperator = 1, kKeyOperator = 2;
constexpr Duration kPatience = 20s;      // for enabling
constexpr Duration kReleasedFor = 50ms;  // before engaging
constexpr Duration kKeyHeldFor = 600ms;  // terminals begin to repeat a key after up to half a second
constexpr double kJogSpeed = 0.3;        // share of the joint's velocity

}  // namespace

FollowOperator::FollowOperator(FollowFile file, std::vector<std::string> joints, bool may_home)
    : file_(std::move(file)), names_(std::move(joints)), joints_(names_.size()), may_home_(may_home) {}

OperatorWish FollowOperator::end(std::string outcome) {
  outcome_ = std::move(outcome);
  return {.quit = true};
}

void FollowOperator::enter(Step step, RobotTime now) {
  step_ = step;
  since_ = now;
  asked_ = false;
}

OperatorWish FollowOperator::command(RobotTime now, bool deadman) {
  return {.command = MotionCommand{kFileOperator, ++sequence_, now, deadman, joints_, target_}};
}

OperatorWish FollowOperator::tick(RobotTime now, const RobotStatus& status) {
  if (!outcome_.empty()) return {.quit = true};
  if (since_.ns == 0) since_ = now;
  if (status.phase == RobotPhase::stopped) {
    std::string why = *status.refused != '\0' ? status.refused : to_string(status.gate.reason);
    if (*status.gate.detail != '\0') why += std::string(": ") + status.gate.detail;
    const int joint = status.waiting_for >= 0 ? status.waiting_for : status.gate.joint;
    if (joint >= 0) {
      const DriveFeedback& f = status.feedback[static_cast<std::size_t>(joint)];
      why += "; joint " + names_[static_cast<std::size_t>(joint)] + ": " + to_string(f.state);
      if (*f.fault != '\0') why += std::string(", ") + f.fault;
    }
    return end("stopped: " + why);
  }
  switch (step_) {
    case Step::enable:
      if (status.phase == RobotPhase::ready) {
        enter(status.all_homed ? Step::release : Step::home, now);
        for (std::size_t i = 0; i < joints_; ++i) target_[i] = status.set_point[i].position;
        return {};
      }
      if (now - since_ > kPatience) return end("the drives were not enabled in time");
      if (std::exchange(asked_, true)) return {};
      return {.request = RobotRequest::enable};
    case Step::home:
      if (!may_home_) return end("not all joints are homed; give --home to let them look for home, slowly");
      if (status.all_homed && status.phase == RobotPhase::ready) {
        for (std::size_t i = 0; i < joints_; ++i) target_[i] = status.set_point[i].position;
        enter(Step::release, now);
        return {};
      }
      if (std::exchange(asked_, true)) return {};
      return {.request = RobotRequest::home};
    case Step::release:
      if (now - since_ > kReleasedFor) {
        file_.at(0, target_);
        enter(Step::approach, now);
      }
      return command(now, false);
    case Step::approach: {
      if (status.gate.reason == GateReason::obstructed && now - since_ > 5s)
        return end(std::string("cannot reach where the file begins: ") + status.gate.detail);
      double farthest = 0;
      for (std::size_t i = 0; i < joints_; ++i)
        farthest = std::max(farthest, std::abs(status.set_point[i].position - target_[i]));
      if (farthest < 1e-3) enter(Step::follow, now);
      return command(now, true);
    }
    case Step::follow: {
      const double t = to_seconds(now - since_);
      file_.at(t, target_);
      if (t > file_.duration_s() + 0.5) enter(Step::rest, now);
      return command(now, true);
    }
    case Step::rest:
      if (status.gate.state == GateState::idle) return end("done");
      return command(now, false);
  }
  return {};
}

KeyOperator::KeyOperator(std::vector<GateJoint> joints) : joints_(std::move(joints)) {}

const char* KeyOperator::help() {
  return "e enable  h home  1-9 0 joint  +/- move (hold)  space STOP  r reset  c configure anew  d disable  q quit";
}

RobotRequest KeyOperator::request_for(char key) {
  const bool consents = std::exchange(consent_, key == 'h');
  switch (key) {
    case 'e': return RobotRequest::enable;
    case 'd': return RobotRequest::disable;
    case 'r': return RobotRequest::reset;
    case 'c': return RobotRequest::set_up;
    case ' ': return RobotRequest::emergency_stop;
    case 'y': return consents ? RobotRequest::home : RobotRequest::none;
    default: return RobotRequest::none;
  }
}

void KeyOperator::jog(int direction, RobotTime now) {
  direction_ = direction;
  jogged_ = now;
}

OperatorWish KeyOperator::tick(RobotTime now, const RobotStatus& status, const std::string& keys) {
  OperatorWish wish;
  for (char key : keys) {
    if (const RobotRequest request = request_for(key);
        request != RobotRequest::none && wish.request != RobotRequest::emergency_stop)
      wish.request = request;
    if (key == 'q') wish.quit = true;
    if (key == '+' || key == '=') jog(1, now);
    if (key == '-') jog(-1, now);
    if (key >= '0' && key <= '9') {
      const std::size_t joint = key == '0' ? 9 : static_cast<std::size_t>(key - '1');
      if (joint < joints_.size()) {
        selected_ = joint;
        direction_ = 0;
      }
    }
  }
  const bool held = direction_ != 0 && now - jogged_ < kKeyHeldFor && status.phase == RobotPhase::ready;
  // Starts from where the robot stands, each time anew.
  if (!held || !engaged_)
    for (std::size_t i = 0; i < joints_.size(); ++i) target_[i] = status.set_point[i].position;
  if (held && engaged_) {
    const JointLimits& limits = joints_[selected_].limits;
    const double step = direction_ * kJogSpeed * limits.velocity * std::min(0.1, to_seconds(now - last_tick_));
    // Not far ahead of the robot: it must stop soon after the key is released.
    const double ahead = 0.2 * limits.velocity, here = status.set_point[selected_].position;
    target_[selected_] = std::clamp(std::clamp(target_[selected_] + step, here - ahead, here + ahead),
                                    limits.min_position, limits.max_position);
  }
  last_tick_ = now;
  if (status.phase == RobotPhase::ready)
    wish.command = MotionCommand{kKeyOperator, ++sequence_, now, held && engaged_, joints_.size(), target_};
  engaged_ = held;
  return wish;
}

}  // namespace foresight

#include "operators/follow_operator.hpp"

#include <algorithm>
#include <cmath>

namespace foresight {
namespace {

using namespace std::chrono_literals;

constexpr Duration kPatience = 20s;      // for enabling
constexpr Duration kReleasedFor = 50ms;  // before engaging

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
  return {.command = counter_.command(now, deadman, joints_, target_)};
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
  // Whoever was in charge and is not any more, though nobody let go, has lost the robot: it does not follow.
  const bool in_charge = status.gate.state == GateState::following && status.gate.operator_id == kId;
  if (engaged_ && !in_charge && (step_ == Step::approach || step_ == Step::follow))
    return end(std::string("stopped: ") + to_string(status.gate.reason));
  engaged_ = engaged_ || in_charge;
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
      double farthest = 0, fastest = 0;
      for (std::size_t i = 0; i < joints_; ++i) {
        farthest = std::max(farthest, std::abs(status.set_point[i].position - target_[i]));
        fastest = std::max(fastest, std::abs(status.set_point[i].velocity));
      }
      if (status.gate.reason == GateReason::obstructed && fastest == 0 && now - since_ > 5s)
        return end(std::string("cannot reach where the file begins: ") + status.gate.detail);
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

}  // namespace foresight

#include "operators/follow_operator.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

namespace foresight {
namespace {

using namespace std::chrono_literals;

constexpr Duration kPatience = 20s;      // for the last of the way
constexpr Duration kReleasedFor = 50ms;  // before engaging
constexpr Duration kStuckFor = 5s;       // on the way to where the file begins
constexpr Duration kSettled = 500ms;     // after the file's end
constexpr Duration kStandsFor = 1s;      // short of its end
constexpr double kReached = 1e-3;        // rad or m

bool set_points_move(const RobotStatus& status, std::size_t joints) {
  return std::any_of(status.set_point.begin(), status.set_point.begin() + static_cast<std::ptrdiff_t>(joints),
                     [](const JointMotion& m) { return m.velocity != 0; });
}

}  // namespace

FollowOperator::FollowOperator(FollowFile file, bool may_home)
    : file_(std::move(file)), joints_(file_.joints().size()), start_(may_home) {}

OperatorWish FollowOperator::end(std::string outcome) {
  outcome_ = std::move(outcome);
  return {.quit = true};
}

void FollowOperator::enter(Step step, RobotTime now) {
  step_ = step;
  since_ = moved_ = now;
}

OperatorWish FollowOperator::command(RobotTime now, bool deadman) {
  return {.command = counter_.command(now, deadman, joints_, target_)};
}

OperatorWish FollowOperator::approach(RobotTime now, const RobotStatus& status) {
  if (set_points_move(status, joints_)) moved_ = now;
  if (gap(status) < kReached) {
    enter(Step::follow, now);
  } else if (now - moved_ > kStuckFor) {
    const GateHold& hold = status.gate.hold;
    return end("not reached: where the file begins: " + place(farthest(status), status) +
               (hold.joint >= 0 ? ": " + parts_text(hold) : ""));
  }
  return command(now, true);
}

OperatorWish FollowOperator::follow(RobotTime now, const RobotStatus& status) {
  const Duration past = now - since_ - seconds(file_.duration_s());
  file_.at(to_seconds(now - since_), target_);
  watch(now, status);
  if (past < kSettled) return command(now, true);
  const bool reached = gap(status) < kReached;
  // The ramp after a start, or the gate, may make it late: it comes as long as it moves.
  if (!reached && now - moved_ < kStandsFor && past < kPatience) return command(now, true);
  result_ = result(reached, status);
  enter(Step::rest, now);
  return command(now, false);
}

void FollowOperator::watch(RobotTime now, const RobotStatus& status) {
  if (set_points_move(status, joints_)) moved_ = now;
  const GateHold& hold = status.gate.hold;
  if (hold.joint < 0 || hold.since < since_) return;  // or it was on the way to where the file begins
  if (!held_) held_ = {to_seconds(hold.since - since_), hold};
  if (std::abs(hold.asked - hold.stands) > std::abs(held_->worst.asked - held_->worst.stands)) held_->worst = hold;
}

/// The joint whose set-point is farthest from where it should be.
std::size_t FollowOperator::farthest(const RobotStatus& status) const {
  std::size_t out = 0;
  const auto way = [&](std::size_t i) { return std::abs(status.set_point[i].position - target_[i]); };
  for (std::size_t i = 1; i < joints_; ++i)
    if (way(i) > way(out)) out = i;
  return out;
}

double FollowOperator::gap(const RobotStatus& status) const {
  const std::size_t joint = farthest(status);
  return std::abs(status.set_point[joint].position - target_[joint]);
}

/// Where the joint stands, as its drive says.
std::string FollowOperator::place(std::size_t joint, const RobotStatus& status) const {
  return place_text(file_.joints()[joint], status.feedback[joint].position, target_[joint]);
}

std::string FollowOperator::stopped_text(const RobotStatus& status) const {
  std::string why = to_string(status.gate.reason);
  if (*status.gate.detail != '\0') why += std::string(": ") + status.gate.detail;
  if (*status.refused != '\0') why += std::string("; ") + status.refused;
  const int joint = status.waiting_for >= 0 ? status.waiting_for : status.gate.joint;
  if (joint >= 0) {
    const auto index = static_cast<std::size_t>(joint);
    const DriveFeedback& f = status.feedback[index];
    why += "; joint " + file_.joints()[index].name + ": " + to_string(f.state);
    if (*f.fault != '\0') why += std::string(", ") + f.fault;
  }
  // All joints were stopped on their way: the one that is to blame is what matters.
  if (const std::size_t to_blame = joint >= 0 ? static_cast<std::size_t>(joint) : farthest(status);
      engaged_ && gap(status) >= kReached)
    why += "; not reached: " + place(to_blame, status) +
           (step_ == Step::follow ? fmt::format(" at {:.2f} s of the file", to_seconds(status.time - since_)) : "");
  return (why.starts_with("stopped") ? "" : "stopped: ") + why;
}

std::string FollowOperator::result(bool reached, const RobotStatus& status) const {
  const std::string since = held_ ? fmt::format(" since {:.2f} s of the file", std::max(0.0, held_->since_s)) : "";
  const std::string by = held_ ? ": " + parts_text(held_->worst) : "";
  if (!reached) return "not reached: " + place(farthest(status), status) + since + by;
  if (!held_) return "done";
  const JointWords& joint = file_.joints()[static_cast<std::size_t>(held_->worst.joint)];
  return "not followed: held back" + since + ", joint " + joint.name + " by up to " +
         position_text(std::abs(held_->worst.asked - held_->worst.stands), joint.unit) + by +
         "; the end of the file was reached";
}

OperatorWish FollowOperator::tick(RobotTime now, const RobotStatus& status) {
  if (!outcome_.empty()) return {.quit = true};
  if (since_.ns == 0) since_ = now;
  if (status.phase == RobotPhase::stopped) return end(stopped_text(status));
  // Whoever was in charge and is not any more, though nobody let go, has lost the robot: it does not follow.
  const bool in_charge = status.gate.state == GateState::following && status.gate.operator_id == kId;
  if (engaged_ && !in_charge && (step_ == Step::approach || step_ == Step::follow)) return end(stopped_text(status));
  engaged_ = engaged_ || in_charge;
  switch (step_) {
    case Step::start: {
      const RobotStart::Progress start = start_.tick(now, status);
      if (!start.failure.empty()) return end(start.failure);
      if (start.ready) {
        for (std::size_t i = 0; i < joints_; ++i) target_[i] = status.set_point[i].position;
        enter(Step::release, now);
      }
      return {.request = start.request};
    }
    case Step::release:
      if (now - since_ > kReleasedFor) {
        file_.at(0, target_);
        enter(Step::approach, now);
      }
      return command(now, false);
    case Step::approach: return approach(now, status);
    case Step::follow: return follow(now, status);
    case Step::rest:
      if (status.gate.state == GateState::idle) return end(result_);
      return command(now, false);
  }
  return {};
}

}  // namespace foresight

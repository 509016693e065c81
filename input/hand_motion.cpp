// How a hand that is engaged moves the joints.
#include <algorithm>
#include <cmath>

#include "input/hand_control.hpp"

namespace foresight {
namespace {

double scale_of(double scale) noexcept {
  return std::isfinite(scale) ? std::clamp(scale, 0.0, 10.0) : 0;
}

Eigen::Vector3d scaled(Eigen::Vector3d v, double scale, const std::array<bool, 3>& lock) noexcept {
  for (std::size_t i = 0; i < 3; ++i)
    if (lock[i]) v[static_cast<Eigen::Index>(i)] = 0;
  return scale_of(scale) * v;
}

bool same(const Pose& a, const Pose& b) noexcept {
  return a.matrix() == b.matrix();
}

}  // namespace

void HandControl::close_clutch() noexcept {
  held_->clutched = true;
  follower_.emplace(*kinematics_, arm_positions(), options_.follow);
  target_ = follower_->hand();
  raw_at_clutch_ = raw_;
  moved_ = false;
}

void HandControl::go_with_hand(double dt) noexcept {
  moved_ = moved_ || !same(raw_, raw_at_clutch_);
  if (!moved_) return;
  if (!same(hand_, hand_before_)) {
    const Vector6 step = pose_difference(hand_before_, hand_);
    const Eigen::Matrix3d R_os = R_operator_space(), R_bo = R_base_operator();
    target_.translation() +=
        R_bo * scaled(R_os * step.head<3>(), settings_.translation_scale, settings_.lock_translation);
    const bool turned = hand_.linear() != hand_before_.linear();
    const Eigen::Vector3d turn =
        R_bo * scaled(R_os * step.tail<3>(), settings_.rotation_scale, settings_.lock_rotation);
    if (const double angle = turn.norm(); turned && angle > 0)
      target_.linear() =
          Eigen::Quaterniond(Eigen::AngleAxisd(angle, turn / angle) * target_.linear()).normalized().toRotationMatrix();
  }
  if (dt > 0) follow_target(dt);
}

void HandControl::follow_target(double dt) noexcept {
  const FollowStep step =
      guard_ ? guard_->step(out_.positions, target_, dt * ramp_) : follower_->step(target_, dt * ramp_);
  for (std::size_t i = 0; i < options_.arm_joints.size(); ++i)
    move_to(options_.arm_joints[i], step.q[static_cast<Eigen::Index>(i)], dt, 1);
  tell(step);
  out_.position_error = step.position_error;
  out_.rotation_error = step.rotation_error;
  leash(step);
}

void HandControl::tell(const FollowStep& step) noexcept {
  out_.follow = step.reason;
  out_.follow_joint = step.joint < 0 ? -1 : static_cast<int>(options_.arm_joints[static_cast<std::size_t>(step.joint)]);
}

void HandControl::leash(const FollowStep& step) noexcept {
  const double over = step.position_error / options_.leash, turned_over = step.rotation_error / options_.leash_turn;
  out_.slipped = over > 1 || turned_over > 1;
  // Each for itself: an arm that cannot turn as the hand does still goes where it goes.
  if (over > 1) {
    target_.translation() = pose_between(step.T_base_tip, target_, 1 / over).translation();
    out_.position_error /= over;
  }
  if (turned_over > 1) {
    target_.linear() = pose_between(step.T_base_tip, target_, 1 / turned_over).linear();
    out_.rotation_error /= turned_over;
  }
}

// All at once, so that they arrive together; the clutch connects the hand anew afterwards.
void HandControl::go_to_start(const HandInput& input, double dt) noexcept {
  held_->clutched = held_->clutch_refused = false;
  const auto goal = [&](std::size_t joint) -> std::optional<double> {
    if (joint >= options_.start.size() || options_.roles[joint] == JointRole::gripper) return std::nullopt;
    if (input.others[joint] && options_.roles[joint] == JointRole::other) return std::nullopt;
    return options_.start[joint];
  };
  double longest = 0;  // s at full speed
  bool any = false;
  for (std::size_t i = 0; i < out_.joints; ++i) {
    const auto to = goal(i);
    any = any || to;
    if (to) longest = std::max(longest, std::abs(*to - out_.positions[i]) / options_.gate.joints[i].limits.velocity);
  }
  say(any ? HandReason::none : HandReason::no_start);
  if (!(longest > 0)) return;
  out_.phase = HandPhase::driving;
  const JointValues before = out_.positions;
  for (std::size_t i = 0; i < out_.joints; ++i) {
    const auto to = goal(i);
    if (!to) continue;
    const double alone = std::abs(*to - before[i]) / options_.gate.joints[i].limits.velocity;
    move_to(i, *to, dt, options_.joint_speed * alone / longest);
  }
  if (guard_) guard_joints(before);
}

// Where the guard lets the arm get to on its way from there; no joint beyond where it was to go.
void HandControl::guard_joints(const JointValues& before) noexcept {
  const FollowStep step = guard_->go(before, out_.positions);
  for (std::size_t i = 0; i < options_.arm_joints.size(); ++i) {
    const std::size_t joint = options_.arm_joints[i];
    const auto [low, high] = std::minmax(before[joint], out_.positions[joint]);
    out_.positions[joint] = std::clamp(step.q[static_cast<Eigen::Index>(i)], low, high);
  }
  tell(step);
}

void HandControl::jog(double rate, double dt) noexcept {
  if (!std::isfinite(rate) || rate == 0) return;
  out_.phase = HandPhase::driving;
  const JointLimits& limits = options_.gate.joints[out_.joint].limits;
  const JointValues before = out_.positions;
  move_to(out_.joint, rate > 0 ? limits.max_position : limits.min_position, dt,
          options_.joint_speed * std::min(std::abs(rate), 1.0));
  const auto of_arm = std::ranges::find(options_.arm_joints, out_.joint);
  if (!guard_ || out_.positions[out_.joint] == before[out_.joint]) return;
  if (of_arm != options_.arm_joints.end())
    guard_joints(before);
  else
    guard_->go(before, out_.positions);  // nothing holds it back, but what jaws take is seen
}

void HandControl::move_others(const HandInput& input, double dt) noexcept {
  if (out_.mode == HandMode::tool) look(input.device, dt);
  for (std::size_t i = 0; i < out_.joints; ++i) {
    const bool jogged = out_.mode == HandMode::joints && out_.joint == i;
    if (options_.roles[i] == JointRole::other && !jogged && input.others[i] && std::isfinite(*input.others[i]))
      move_to(i, *input.others[i], dt, 1);
  }
}

void HandControl::look(const TrackerState& device, double dt) noexcept {
  const auto turn = [&](const std::optional<std::size_t>& joint, double rate) {
    if (!joint || !std::isfinite(rate) || rate == 0) return;
    const JointLimits& limits = options_.gate.joints[*joint].limits;
    move_to(*joint, rate > 0 ? limits.max_position : limits.min_position, dt,
            options_.look_speed * std::min(std::abs(rate), 1.0));
  };
  turn(options_.pan, device.pan_rate);
  turn(options_.tilt, options_.tilt_looks_down ? -device.tilt_rate : device.tilt_rate);
}

double HandControl::grip_position(std::size_t joint, double grip) const noexcept {
  const JointLimits& limits = options_.gate.joints[joint].limits;
  const double open = options_.gripper_opens_up ? limits.max_position : limits.min_position;
  const double closed = options_.gripper_opens_up ? limits.min_position : limits.max_position;
  return open + std::clamp(grip, 0.0, 1.0) * (closed - open);
}

// A trigger that is elsewhere than the gripper would open or close it at once: it has to have been moved, and to have
// come by where the gripper is.
bool HandControl::trigger_catches(double grip, std::size_t joint) noexcept {
  if (held_->grip_caught) return true;
  const bool moved = !held_->grip_at || grip != *held_->grip_at;
  const double here = out_.positions[joint], wanted = grip_position(joint, grip);
  const double before = grip_position(joint, grip_.value_or(grip));
  const JointLimits& limits = options_.gate.joints[joint].limits;
  const double near = 0.02 * (limits.max_position - limits.min_position);
  held_->grip_caught = moved && (std::abs(wanted - here) < near || (before - here) * (wanted - here) < 0);
  return held_->grip_caught;
}

void HandControl::move_grippers(const TrackerState& device, double dt) noexcept {
  const bool open = device.buttons.held(TrackerButton::gripper_open);
  const bool close = device.buttons.held(TrackerButton::gripper_close);
  const bool trigger = device.grip && std::isfinite(*device.grip);
  const JointValues before = out_.positions;
  for (std::size_t i = 0; i < out_.joints; ++i) {
    if (options_.roles[i] != JointRole::gripper) continue;
    if (open != close) {
      held_->grip_caught = false;
      held_->grip_at = device.grip;
      move_to(i, grip_position(i, open ? 0 : 1), dt, options_.gripper_speed);
    } else if (trigger && trigger_catches(*device.grip, i)) {
      move_to(i, grip_position(i, *device.grip), dt, options_.gripper_speed);
    }
  }
  grip_ = trigger ? device.grip : std::nullopt;
  // Under a hand that has not moved yet, and where single joints do, nobody else asks the guard: it would not see what
  // the jaws take.
  const bool asked = out_.mode == HandMode::tool && held_->clutched && moved_;
  if (guard_ && !asked && out_.positions != before) guard_->go(before, out_.positions);
}

void HandControl::move_to(std::size_t joint, double target, double dt, double share) noexcept {
  const JointLimits& limits = options_.gate.joints[joint].limits;
  // A little less than the limit: whoever subtracts two set-points must not find more.
  const double room = limits.velocity * dt * ramp_ * share * (1 - 1e-9);
  const double to = std::clamp(target, limits.min_position, limits.max_position), here = out_.positions[joint];
  out_.positions[joint] = std::abs(to - here) <= room ? to : here + std::copysign(room, to - here);
}

Eigen::Matrix3d R_view_operator() noexcept {
  Eigen::Matrix3d out;
  out << 0, -1, 0, 0, 0, -1, 1, 0, 0;
  return out;
}

JointVector HandControl::arm_positions() const noexcept {
  return joints_of(out_.positions, options_.arm_joints);
}

Eigen::Matrix3d HandControl::R_base_operator() const noexcept {
  if (settings_.frame == HandFrame::base) return Eigen::Matrix3d::Identity();
  return T_base_view_.linear() * R_view_operator();
}

Eigen::Matrix3d HandControl::R_operator_space() const noexcept {
  const bool by_head = settings_.frame == HandFrame::view && settings_.view_turns_with_head && T_space_head_;
  if (by_head) return T_space_head_->linear().transpose();
  return R_recentred_space_;
}

}  // namespace foresight

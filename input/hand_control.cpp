#include "input/hand_control.hpp"

#include <algorithm>
#include <cmath>

#include "common/error.hpp"
#include "common/rotation.hpp"

namespace foresight {
namespace {

void require_arm(const HandOptions& options, const std::string& where) {
  if (!options.arm) return;
  require(options.arm_joints.size() == options.arm->size(), where,
          "the arm has " + std::to_string(options.arm->size()) + " joints, and " +
              std::to_string(options.arm_joints.size()) + " of the robot's are named",
          "name one for each");
  for (std::size_t i = 0; i < options.arm_joints.size(); ++i) {
    const std::size_t joint = options.arm_joints[i];
    require(joint < options.gate.joints.size(), where, "the arm has a joint that the robot lacks", "name one it has");
    require(options.roles[joint] == JointRole::arm, where,
            "joint '" + options.gate.joints[joint].name + "' is on the way to the tool, but none of the arm's",
            "give it to the arm");
    const ArmJoint& arm = options.arm->joints()[i];
    const JointLimits& limits = options.gate.joints[joint].limits;
    require(arm.velocity <= limits.velocity && arm.lower >= limits.min_position && arm.upper <= limits.max_position,
            where, "joint '" + options.gate.joints[joint].name + "' of the arm may do more than the robot's",
            "bring the arm within the robot's limits");
  }
}

void check(const HandOptions& options, const std::string& where) {
  options.gate.validate(where);
  require(options.roles.size() == options.gate.joints.size(), where, "not every joint has a role", "give each one");
  for (const double share : {options.joint_speed, options.gripper_speed, options.look_speed})
    require(share > 0 && share <= 1, where, "a share of a joint's velocity is " + std::to_string(share),
            "choose more than 0, and at most 1");
  for (const auto& joint : {options.pan, options.tilt})
    require(!joint || (*joint < options.roles.size() && options.roles[*joint] == JointRole::other), where,
            "pan or tilt is a joint of the arm or the gripper", "give it the role `other`");
  require(options.leash > 0 && options.leash_turn > 0, where, "the leash has no length", "choose more than 0");
  require(options.longest_cycle.count() > 0, where, "the longest cycle has no length", "choose more than 0");
  require_arm(options, where);
}

}  // namespace

HandControl::HandControl(HandOptions options, const std::string& where) : options_(std::move(options)) {
  check(options_, where);
  watch_ = HandWatch(options_.watch);
  if (options_.arm) kinematics_.emplace(*options_.arm);
  if (!kinematics_) out_.mode = HandMode::joints;
}

void HandControl::set_mode(HandMode mode) noexcept {
  if (mode == out_.mode) return;
  out_.mode = mode;
  if (held_) held_->clutched = false;
}

const HandCycle& HandControl::cycle(const HandInput& input) noexcept {
  const Duration passed = last_ ? input.now - *last_ : Duration{0};
  const bool paused = passed > options_.longest_cycle || passed.count() < 0;
  last_ = input.now;
  const HandWatch::Verdict verdict = watch_.judge(input.now, input.device);
  see(input, verdict);
  forget_cycle();
  if (verdict.buttons == HandFault::none) take_presses(input.device);
  if (paused) seen_open_ = false;
  heed_switch(input, verdict, paused);
  if (held_) {
    const HandReason fault = fault_of_robot(input);
    if (fault != HandReason::none)
      refuse(fault);
    else
      hold(input, verdict, to_seconds(passed));
  }
  if (!held_ && !rest(input.robot)) out_.joints = 0;
  out_.deadman = held_.has_value();
  if (kinematics_ && out_.joints > 0) out_.T_base_tip = kinematics_->chain().tip_pose(arm_positions());
  return out_;
}

void HandControl::heed_switch(const HandInput& input, const HandWatch::Verdict& verdict, bool paused) noexcept {
  if (verdict.buttons != HandFault::none) return refuse(verdict.buttons, input.device);
  if (!input.device.buttons.held(TrackerButton::deadman)) return let_go(verdict.pose, input.device);
  if (held_ && paused) return refuse(HandReason::paused);
  if (!held_ && out_.phase != HandPhase::refused) press(input);
}

// A hand that nobody sees is told of before the switch is pressed for nothing.
void HandControl::let_go(HandFault pose, const TrackerState& device) noexcept {
  const bool tells = pose != HandFault::none && pose != HandFault::jumped && out_.mode == HandMode::tool;
  out_.phase = HandPhase::released;
  if (tells)
    say(pose, device);
  else
    say(HandReason::none);
  held_.reset();
  seen_open_ = true;
}

// What lasts from cycle to cycle stays.
void HandControl::forget_cycle() noexcept {
  HandCycle next;
  next.phase = out_.phase;
  next.reason = out_.reason;
  next.fault = out_.fault;
  next.trouble = out_.trouble;
  next.cure = out_.cure;
  next.positions = out_.positions;
  next.mode = out_.mode;
  next.joint = out_.joint;
  out_ = next;
}

// What is known of the hand and of where the operator looks, whether anything follows it or not.
void HandControl::see(const HandInput& input, const HandWatch::Verdict& verdict) noexcept {
  hand_before_ = hand_;
  if (is_rigid(input.T_base_view)) T_base_view_ = input.T_base_view;
  if (const auto& head = input.device.T_space_head; head && is_rigid(*head, 3e-3)) T_space_head_ = head;
  if (!verdict.news) return;
  raw_ = hand_ = input.device.T_space_hand;
  if (input.device.integrated) return;
  filter_.observe(input.device.time, raw_);
  hand_ = filter_.pose();
}

void HandControl::take_presses(const TrackerState& device) noexcept {
  const auto pressed = [&](TrackerButton button) { return device.buttons.held(button) && !buttons_.held(button); };
  const std::size_t joints = options_.gate.joints.size();
  if (device.joint && *device.joint < joints) out_.joint = *device.joint;
  if (out_.mode == HandMode::joints && pressed(TrackerButton::next_joint)) out_.joint = (out_.joint + 1) % joints;
  if (out_.mode == HandMode::joints && pressed(TrackerButton::previous_joint))
    out_.joint = (out_.joint + joints - 1) % joints;
  if (pressed(TrackerButton::joint_mode) && kinematics_)
    set_mode(out_.mode == HandMode::tool ? HandMode::joints : HandMode::tool);
  if (pressed(TrackerButton::recentre)) recentre();
  out_.home_view = pressed(TrackerButton::home_view);
  buttons_ = device.buttons;
}

void HandControl::recentre() noexcept {
  const Eigen::Vector3d forward = (T_space_head_ ? *T_space_head_ : raw_).linear().col(0);
  if (forward.head<2>().norm() < 0.1) return;  // straight up or down: no heading
  R_recentred_space_ =
      Eigen::AngleAxisd(-std::atan2(forward.y(), forward.x()), Eigen::Vector3d::UnitZ()).toRotationMatrix();
}

// Where the robot says that set-points begin; false: it is not known.
bool HandControl::rest(const HandRobot& robot) noexcept {
  if (robot.joints != options_.gate.joints.size()) return false;
  for (std::size_t i = 0; i < robot.joints; ++i)
    if (!std::isfinite(robot.begin[i])) return false;
  out_.joints = robot.joints;
  out_.positions = robot.begin;
  return true;
}

void HandControl::press(const HandInput& input) noexcept {
  if (!seen_open_) return refuse(HandReason::not_let_go);
  if (input.robot.joints != options_.gate.joints.size()) return refuse(HandReason::robot_unknown);
  if (!rest(input.robot)) return refuse(HandReason::bad_number);
  if (!input.robot.ready) return refuse(HandReason::robot_not_ready);
  seen_open_ = false;
  held_ = Held{.since = input.now, .grip_at = input.device.grip};
  say(HandReason::none);
}

void HandControl::refuse(HandReason reason) noexcept {
  say(reason);
  stop_following(true);
}

// Without a switch that was held there is nothing to refuse: the device is looked at again when it is back.
void HandControl::refuse(HandFault fault, const TrackerState& device) noexcept {
  say(fault, device);
  stop_following(held_ || out_.phase == HandPhase::refused);
}

void HandControl::stop_following(bool was_held) noexcept {
  out_.phase = was_held ? HandPhase::refused : HandPhase::released;
  held_.reset();
  seen_open_ = false;
}

void HandControl::say(HandReason reason) noexcept {
  out_.reason = reason;
  out_.fault = HandFault::none;
  out_.trouble = out_.cure = "";
}

// A fault and the device's words for it come and go together: it may have others for what is wrong with it later.
void HandControl::say(HandFault fault, const TrackerState& device) noexcept {
  out_.reason = HandReason::device;
  out_.fault = fault;
  out_.trouble = device.trouble;
  out_.cure = device.cure;
}

HandReason HandControl::fault_of_robot(const HandInput& input) noexcept {
  const HandRobot& robot = input.robot;
  if (robot.joints != options_.gate.joints.size()) return HandReason::robot_lost;
  held_->followed |= robot.follows;
  if (robot.must_let_go || (held_->followed && !robot.follows)) return HandReason::robot_lost;
  const bool late = !held_->followed && input.now - held_->since > options_.follows_within;
  return late ? HandReason::robot_silent : HandReason::none;
}

void HandControl::hold(const HandInput& input, const HandWatch::Verdict& verdict, double dt) noexcept {
  ramp_ = options_.gate.speed_after(input.now - held_->since);
  out_.phase = HandPhase::holding;
  out_.joints = options_.gate.joints.size();
  if (input.now == held_->since) dt = 0;
  if (input.device.buttons.held(TrackerButton::to_start)) {
    go_to_start(input, dt);
  } else if (out_.mode == HandMode::joints) {
    say(HandReason::none);
    jog(input.device.joint_rate, dt);
  } else
    heed_clutch(input.device, verdict.pose, dt);
  if (!held_) return;
  move_grippers(input.device, dt);
  move_others(input, dt);
}

void HandControl::heed_clutch(const TrackerState& device, HandFault fault, double dt) noexcept {
  if (!device.buttons.held(TrackerButton::clutch)) {
    held_->clutched = held_->clutch_refused = false;
    return say(HandReason::none);
  }
  if (held_->clutched && fault != HandFault::none) return refuse(fault, device);
  if (fault != HandFault::none) {
    held_->clutch_refused = true;
    held_->fault = fault;
    held_->refused_by = device;
  }
  if (held_->clutch_refused) return say(held_->fault, *held_->refused_by);
  say(kinematics_ ? HandReason::none : HandReason::no_arm);
  if (!kinematics_) return;
  if (held_->clutched)
    go_with_hand(dt);
  else
    close_clutch();
  out_.phase = HandPhase::driving;
  out_.T_base_target = target_;
}

}  // namespace foresight
